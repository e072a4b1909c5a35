"""The climber's body: from wheels and joint to what it does, from a motion to what the wheels shall do."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from firmware_bridge.drivers.driver import Demand, Feedback, Reading, Speed
from firmware_bridge.motion.differential import DifferentialRamp, fastest_in_turn, twist, wheel_speeds
from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.robot import Robot
from firmware_bridge.robots.climber.geometry import Geometry
from firmware_bridge.robots.climber.motion import Motion, State
from firmware_bridge.robots.climber.surface import placed, track_on
from firmware_bridge.units import Nanoseconds

CHASSIS: Final = "chassis"
LEFT: Final = "left_wheel"
RIGHT: Final = "right_wheel"
GROUPS: Final = {CHASSIS: frozenset({LEFT, RIGHT})}
"""The axes, by their roles in the robot file, that stop together."""
NOTHING: Final[frozenset[str]] = frozenset()

MOVES_MPS: Final = 0.002
"""Speed at which the robot counts as driving."""
TURNS_RAD_S: Final = 0.020
"""Turn rate at which it counts as turning."""


def ramp_of(robot: Robot[Geometry]) -> DifferentialRamp:
    """Return the bounds of speed and turn rate."""
    limits = robot.geometry.limits
    return DifferentialRamp(
        MARGIN * limits.acceleration_mps2,
        MARGIN * limits.turn_acceleration_rad_s2,
        limits.sideways_mps2,
        robot.geometry.base.track_m / 2.0,
        robot.cycle,
    )


class Body:
    """A `firmware_bridge.safety.body.Body`."""

    __slots__ = ("_base", "_geometry", "_left", "_ramp", "_right", "rolling")

    def __init__(self, robot: Robot[Geometry]) -> None:
        self._geometry = robot.geometry
        self._base = robot.geometry.base
        self._ramp = ramp_of(robot)
        self._left = robot.axis(LEFT).name
        self._right = robot.axis(RIGHT).name
        self.rolling: tuple[str, ...] = (self._left, self._right)
        """The axes from whose positions the pose is carried on."""

    def sensed(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading]) -> State:
        """Return speed, turn rate, the joint's angle and whether it is on the wall."""
        speed, turn = twist(self._base, axes[self._left].velocity, axes[self._right].velocity)
        told = sensors.get(self._geometry.wall.sensor)
        return State(speed, turn, self._joint(sensors), None if told is None else told.value)

    def _joint(self, sensors: Mapping[str, Reading]) -> float | None:
        """Return the joint's angle from flat in rad."""
        joint = self._geometry.joint
        told = sensors.get(joint.sensor)
        return None if told is None else joint.read(told.value)

    def asked(self, motion: Motion, _state: State) -> frozenset[str]:
        """Return the wheels where the motion asks it to drive or to turn."""
        return frozenset({CHASSIS}) if motion.speed_mps or motion.turn_rad_s else NOTHING

    def moving(self, state: State) -> frozenset[str]:
        """Return the wheels where it is seen to drive or to turn."""
        stands = abs(state.speed_mps) < MOVES_MPS and abs(state.turn_rad_s) < TURNS_RAD_S
        return NOTHING if stands else frozenset({CHASSIS})

    def rested(self, motion: Motion, groups: frozenset[str]) -> Motion:
        """Return the motion at rest; where a guide is on its path stays."""
        return replace(motion, speed_mps=0.0, turn_rad_s=0.0) if CHASSIS in groups else motion

    def ramped(self, demanded: Motion, allowed: Motion, _state: State, elapsed: Nanoseconds) -> Motion:
        """Return the next demand on the way to what is allowed."""
        speed, turn = self._ramp.step(
            (demanded.speed_mps, demanded.turn_rad_s), (allowed.speed_mps, allowed.turn_rad_s), elapsed
        )
        return replace(allowed, speed_mps=speed, turn_rad_s=turn)

    def demands(self, motion: Motion, _state: State) -> Mapping[str, Demand]:
        """Return both wheels' speeds."""
        left, right = wheel_speeds(self._base, motion.speed_mps, motion.turn_rad_s)
        return {self._left: Speed(left), self._right: Speed(right)}

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        sensors: Mapping[str, Reading],
    ) -> Pose:
        """Return the pose after both wheels rolled on, on the unrolled surface."""
        left, right = (after[name].position - before[name].position for name in self.rolling)
        radius = self._base.wheel_radius_m
        heading = placed(self._geometry, pose).heading_rad
        track = track_on(self._geometry, heading, self._joint(sensors))
        return moved(pose, left * radius, right * radius, track)


def reach(robot: Robot[Geometry]) -> Iterator[tuple[Motion, State]]:
    """Yield the fastest motions: ahead, on the spot, and in the turn that pulls sideways at the limit."""
    limits = robot.geometry.limits
    for turn in (0.0, limits.turn_rate_rad_s, limits.sideways_mps2 / limits.speed_mps):
        turned = min(turn, limits.turn_rate_rad_s)
        speed = min(limits.speed_mps, fastest_in_turn(turned, limits.sideways_mps2))
        for forward in (-1.0, 1.0):
            for side in (-1.0, 1.0):
                yield Motion(forward * speed, side * turned), State(forward * speed, side * turned)
