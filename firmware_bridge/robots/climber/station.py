"""The climber's rows on MAVLink: stick and velocity to a motion, and its telemetry.

Full stick is the speed limit and the turn rate's; with `r` unused `y` turns. Button 2 is the emergency stop.
"""

import math
from typing import Final

from firmware_bridge.robot import Robot
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.kinematics import CLIMBER
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.surface import place_of
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.station import Fixed, Margin, StationRows, Value
from firmware_bridge.units import SECOND


def _joint_deg(seen: Snapshot[ClimberMotion, ClimberState]) -> float | None:
    joint = seen.body.joint_rad
    return None if joint is None else math.degrees(joint)


def _margin(robot: Robot[ClimberGeometry], seen: Snapshot[ClimberMotion, ClimberState]) -> float | None:
    place = place_of(robot.geometry, seen)
    return None if place is None else robot.geometry.wall.margin(place.y_m)


STATION: Final[StationRows[ClimberGeometry, ClimberMotion, ClimberState]] = StationRows(
    stick=CLIMBER.stick,
    target=CLIMBER.target,
    twist=CLIMBER.twist,
    forgotten=lambda command: command,
    largest=CLIMBER.largest,
    meters_rolled=CLIMBER.meters_rolled,
    stop_button=2,
    values=(
        CLIMBER.turn_value,
        Value("JOINT", SECOND // 10, _joint_deg, "deg, the right half against the left"),
        Value("PATH", SECOND // 5, lambda seen: seen.command.path_s, "s on the path that is followed"),
    ),
    margin=Margin(_margin, lambda robot: robot.geometry.wall.least_margin, "times", "hold to weight"),
    parameters=(
        *CLIMBER.parameters,
        Fixed("TANK_R", lambda robot: robot.geometry.tank.radius_m, "m"),
        Fixed("CTRL_RHO", lambda robot: robot.geometry.control.k_rho_per_s, "1/s"),
        Fixed("CTRL_ALPHA", lambda robot: robot.geometry.control.k_alpha_per_s, "1/s"),
        Fixed("CTRL_BETA", lambda robot: robot.geometry.control.k_beta_per_s, "1/s"),
    ),
)
