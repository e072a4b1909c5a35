"""The climber's rows on MAVLink: stick and velocity to a motion, and what it tells.

Full stick is the speed limit and the turn rate's; with `r` unused `y` turns. Button 2 is the emergency stop.
"""

import math
from dataclasses import replace
from typing import Final

from firmware_bridge.robot import Robot
from firmware_bridge.robots.climber.geometry import Geometry
from firmware_bridge.robots.climber.motion import Motion, State
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.station import Fixed, Station, Stick, Twist, Unusable, Value, Velocity
from firmware_bridge.units import SECOND


def of_stick(stick: Stick, wish: Motion, robot: Robot[Geometry]) -> Motion:
    """Return the wish for a stick."""
    limits = robot.geometry.limits
    side = stick.left if stick.turn is None else stick.turn
    return replace(
        wish,
        speed_mps=(stick.forward or 0.0) * limits.speed_mps,
        turn_rad_s=(side or 0.0) * limits.turn_rate_rad_s,
    )


def of_target(velocity: Velocity, wish: Motion, _robot: Robot[Geometry]) -> Motion | Unusable:
    """Return the wish for a velocity along the robot and a turn rate."""
    if velocity.left_mps != 0.0:
        return Unusable("sideways", "this robot moves forward and backward only")
    return replace(wish, speed_mps=velocity.forward_mps, turn_rad_s=velocity.yaw_rate_rad_s or 0.0)


def _turn_deg_s(seen: Snapshot[Motion, State]) -> float:
    return math.degrees(seen.body.turn_rad_s)


def _joint_deg(seen: Snapshot[Motion, State]) -> float | None:
    joint = seen.body.joint_rad
    return None if joint is None else math.degrees(joint)


STATION: Final[Station[Geometry, Motion, State]] = Station(
    stick=of_stick,
    target=of_target,
    twist=lambda state: Twist(state.speed_mps, 0.0, state.turn_rad_s),
    forgotten=lambda wish: wish,
    largest=lambda robot: Twist(robot.geometry.limits.speed_mps, 0.0, robot.geometry.limits.turn_rate_rad_s),
    metres_rolled=lambda robot: robot.geometry.base.wheel_radius_m,
    stop_button=2,
    values=(
        Value("TURN", SECOND // 10, _turn_deg_s, "deg/s, left positive"),
        Value("JOINT", SECOND // 10, _joint_deg, "deg, the right half against the left"),
        Value("PATH", SECOND // 5, lambda seen: seen.wish.path_s, "s on the path that a guide follows"),
    ),
    parameters=(
        Fixed("WHEEL_R", lambda robot: robot.geometry.base.wheel_radius_m, "m"),
        Fixed("TRACK", lambda robot: robot.geometry.base.track_m, "m"),
        Fixed("TANK_R", lambda robot: robot.geometry.tank.radius_m, "m"),
        Fixed("SPD_MAX", lambda robot: robot.geometry.limits.speed_mps, "m/s"),
        Fixed("ACC_MAX", lambda robot: robot.geometry.limits.acceleration_mps2, "m/s2"),
        Fixed("TURN_MAX", lambda robot: robot.geometry.limits.turn_rate_rad_s, "rad/s"),
        Fixed("CTRL_RHO", lambda robot: robot.geometry.control.k_rho_per_s, "1/s"),
        Fixed("CTRL_ALPHA", lambda robot: robot.geometry.control.k_alpha_per_s, "1/s"),
        Fixed("CTRL_BETA", lambda robot: robot.geometry.control.k_beta_per_s, "1/s"),
    ),
)
