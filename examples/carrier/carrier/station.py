"""The robot's rows on MAVLink: stick and velocity to a motion, the lamp's switch, and what it tells.

Full stick is the speed limit and the turn rate's; with `r` unused `y` turns.
Buttons: 0 lamp, 2 emergency stop.
"""

import math
from dataclasses import replace
from typing import Final

from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.station import Fixed, Station, Stick, Switch, Twist, Unusable, Value, Velocity
from firmware_bridge.units import SECOND

from carrier.geometry import Geometry
from carrier.motion import Motion, State


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


STATION: Final[Station[Geometry, Motion, State]] = Station(
    stick=of_stick,
    target=of_target,
    twist=lambda state: Twist(state.speed_mps, 0.0, state.turn_rad_s),
    # A stick is said again and again: nothing of a wish has to be forgotten.
    forgotten=lambda wish: wish,
    largest=lambda robot: Twist(robot.geometry.limits.speed_mps, 0.0, robot.geometry.limits.turn_rate_rad_s),
    metres_rolled=lambda robot: robot.geometry.base.wheel_radius_m,
    stop_button=2,
    switches=(
        Switch(
            "lamp",
            read=lambda wish: wish.lamp,
            write=lambda wish, on: replace(wish, lamp=on),
            relay=0,
            button=0,
            telemetry="LAMP",
        ),
    ),
    values=(Value("TURN", SECOND // 10, _turn_deg_s, "deg/s, left positive"),),
    parameters=(
        Fixed("WHEEL_R", lambda robot: robot.geometry.base.wheel_radius_m, "m"),
        Fixed("TRACK", lambda robot: robot.geometry.base.track_m, "m"),
        Fixed("SPD_MAX", lambda robot: robot.geometry.limits.speed_mps, "m/s"),
        Fixed("ACC_MAX", lambda robot: robot.geometry.limits.acceleration_mps2, "m/s2"),
        Fixed("TURN_MAX", lambda robot: robot.geometry.limits.turn_rate_rad_s, "rad/s"),
    ),
)
