"""The arm's rows on MAVLink: the tool by stick and by velocity, and its telemetry.

Full stick is the speed limit in its direction, ahead, to the left, and upwards while button 3 is held; and
the turn rate's about the upright axis. Button 2 is the emergency stop.
"""

import math
from typing import Final

from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2.geometry import Ar2Geometry
from firmware_bridge.robots.ar2.kinematics import JOINTS
from firmware_bridge.robots.ar2.motion import Ar2Motion, Ar2State
from firmware_bridge.robots.ar2.rules import tool
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.station import (
    USUAL_AXES,
    Fixed,
    Gauge,
    StationRows,
    Stick,
    StickAxis,
    Twist,
    Value,
    Velocity,
)
from firmware_bridge.units import SECOND


def of_stick(stick: Stick, _command: Ar2Motion, robot: Robot[Ar2Geometry]) -> Ar2Motion:
    """Return the command for a stick."""
    limits = robot.geometry.limits
    speed = limits.speed_mps
    return Ar2Motion(
        ahead_mps=(stick.forward or 0.0) * speed,
        left_mps=(stick.left or 0.0) * speed,
        up_mps=(stick.up or 0.0) * speed,
        yaw_rad_s=(stick.turn or 0.0) * limits.turn_rate_rad_s,
    )


def of_target(velocity: Velocity, _command: Ar2Motion, _robot: Robot[Ar2Geometry]) -> Ar2Motion:
    """Return the command for a velocity on the level, and a turn rate."""
    return Ar2Motion(velocity.forward_mps, velocity.left_mps, yaw_rad_s=velocity.yaw_rate_rad_s or 0.0)


def _largest(robot: Robot[Ar2Geometry]) -> Twist:
    limits = robot.geometry.limits
    return Twist(limits.speed_mps, limits.speed_mps, limits.turn_rate_rad_s)


def _still(_state: Ar2State) -> Twist:
    """Return a foot at standstill: the tool's motion has values of its own."""
    return Twist(0.0, 0.0, 0.0)


def _coordinate(axis: int, letter: str) -> Value[Ar2Motion, Ar2State]:
    def read(seen: Snapshot[Ar2Motion, Ar2State]) -> float:
        return tool(seen.body)[axis]

    return Value(f"TOOL_{letter}", SECOND // 5, read, "m, where the tool is counted to be")


def _degrees(role: str) -> Gauge[Ar2Geometry]:
    return Gauge(
        role, "deg", lambda position, _: math.degrees(position), lambda value, _: math.radians(value)
    )


STATION: Final[StationRows[Ar2Geometry, Ar2Motion, Ar2State]] = StationRows(
    stick=of_stick,
    target=of_target,
    twist=_still,
    forgotten=lambda command: command,
    largest=_largest,
    stop_button=2,
    up_button=3,
    axes=(*USUAL_AXES, StickAxis.UP),
    values=(
        *(_coordinate(axis, letter) for axis, letter in enumerate("XYZ")),
        Value("PATH", SECOND // 5, lambda seen: seen.command.path_s, "s on the path that is followed"),
    ),
    parameters=(
        Fixed("SPD_MAX", lambda robot: robot.geometry.limits.speed_mps, "m/s"),
        Fixed("ACC_MAX", lambda robot: robot.geometry.limits.acceleration_mps2, "m/s2"),
        Fixed("TURN_MAX", lambda robot: robot.geometry.limits.turn_rate_rad_s, "rad/s"),
        Fixed("CTRL_P", lambda robot: robot.geometry.control.kp_per_s, "1/s"),
        Fixed("CTRL_O", lambda robot: robot.geometry.control.ko_per_s, "1/s"),
    ),
    gauges=tuple(map(_degrees, JOINTS)),
)
