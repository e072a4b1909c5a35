"""ROME's rows on MAVLink: three degrees of freedom by stick and by velocity, and its telemetry.

Full stick is the highest speed of a set-point in its direction, and the turn rate's limit. Button 2 is the
emergency stop.
"""

import math
from dataclasses import replace
from typing import Final

from firmware_bridge.robot import Robot
from firmware_bridge.robots.rome.geometry import RomeGeometry
from firmware_bridge.robots.rome.motion import RomeMotion, RomeState
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.station import Fixed, StationRows, Stick, Twist, Value, Velocity
from firmware_bridge.units import SECOND


def of_stick(stick: Stick, command: RomeMotion, robot: Robot[RomeGeometry]) -> RomeMotion:
    """Return the command for a stick."""
    limits = robot.geometry.limits
    return replace(
        command,
        ahead_mps=(stick.forward or 0.0) * limits.setpoint_mps,
        left_mps=(stick.left or 0.0) * limits.setpoint_mps,
        turn_rad_s=(stick.turn or 0.0) * limits.turn_rate_rad_s,
    )


def of_target(velocity: Velocity, command: RomeMotion, _robot: Robot[RomeGeometry]) -> RomeMotion:
    """Return the command for a velocity and a turn rate."""
    return replace(
        command,
        ahead_mps=velocity.forward_mps,
        left_mps=velocity.left_mps,
        turn_rad_s=velocity.yaw_rate_rad_s or 0.0,
    )


def _largest(robot: Robot[RomeGeometry]) -> Twist:
    limits = robot.geometry.limits
    return Twist(limits.setpoint_mps, limits.setpoint_mps, limits.turn_rate_rad_s)


def _turn_deg_s(seen: Snapshot[RomeMotion, RomeState]) -> float:
    return math.degrees(seen.body.turn_rad_s)


STATION: Final[StationRows[RomeGeometry, RomeMotion, RomeState]] = StationRows(
    stick=of_stick,
    target=of_target,
    twist=lambda state: Twist(state.ahead_mps, state.left_mps, state.turn_rad_s),
    forgotten=lambda command: command,
    largest=_largest,
    meters_rolled=lambda robot: robot.geometry.base.wheel_radius_m,
    stop_button=2,
    values=(
        Value("TURN", SECOND // 10, _turn_deg_s, "deg/s, left positive"),
        Value("PATH", SECOND // 5, lambda seen: seen.command.path_s, "s on the path that is followed"),
    ),
    parameters=(
        Fixed("WHEEL_R", lambda robot: robot.geometry.base.wheel_radius_m, "m"),
        Fixed("WHEEL_L", lambda robot: robot.geometry.base.wheel_distance_m, "m"),
        Fixed("SPD_MAX", lambda robot: robot.geometry.limits.speed_mps, "m/s"),
        Fixed("ACC_MAX", lambda robot: robot.geometry.limits.acceleration_mps2, "m/s2"),
        Fixed("TURN_MAX", lambda robot: robot.geometry.limits.turn_rate_rad_s, "rad/s"),
        Fixed("RIM_MAX", lambda robot: robot.geometry.limits.rim_mps, "m/s"),
        Fixed("CTRL_P", lambda robot: robot.geometry.control.kp_per_s, "1/s"),
        Fixed("CTRL_I", lambda robot: robot.geometry.control.ki_per_s2, "1/s2"),
    ),
)
