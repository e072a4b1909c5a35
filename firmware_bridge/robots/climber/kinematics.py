"""The climber's kinematic model: two driven wheels with a joint between, on a surface that is no floor."""

from typing import Final

from firmware_bridge.differential.kinematics import Sensors
from firmware_bridge.differential.robot import DifferentialRobot
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.surface import placed, track_on


def _state(
    robot: Robot[ClimberGeometry], speed_mps: float, turn_rad_s: float, sensors: Sensors
) -> ClimberState:
    """Return speed, turn rate, the joint's angle and whether it is on the wall."""
    # A silent sensor has no reading, which counts as off the wall, not as on it.
    reading = sensors.get(robot.geometry.wall.sensor)
    return ClimberState(
        speed_mps, turn_rad_s, _joint(robot, sensors), None if reading is None else reading.value
    )


def _joint(robot: Robot[ClimberGeometry], sensors: Sensors) -> float | None:
    """Return the joint's angle from flat in rad."""
    joint = robot.geometry.joint
    reading = sensors.get(joint.sensor)
    return None if reading is None else joint.read(reading.value)


def _track(robot: Robot[ClimberGeometry], pose: Pose, sensors: Sensors) -> float:
    """Return the track on the unrolled surface."""
    heading = placed(robot.geometry, pose).heading_rad
    return track_on(robot.geometry, heading, _joint(robot, sensors))


CLIMBER: Final[DifferentialRobot[ClimberGeometry, ClimberMotion, ClimberState]] = DifferentialRobot(
    ClimberMotion, _state, group="chassis", moves_mps=0.002, turns_rad_s=0.020, spin=1.3, track=_track
)
