"""RARS's rows on MAVLink: stick and velocity to a motion, switches, the lift as an actuator, its values.

Full stick is the speed limit, full turn the largest steer angle; with `r` unused `y` steers. The lift's stick
counts while button 3 is held. Buttons: 0 detector, 1 headlamp, 2 emergency stop, 3 lift.
"""

import math
from dataclasses import replace
from typing import Final

from firmware_bridge.motion.davis import pinion_from_steer, steer_from_curvature, steer_from_pinion
from firmware_bridge.motion.scissor import height_from_screw, highest, screw_from_height
from firmware_bridge.motion.tables import DavisBase
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.kinematics import SCREW, STEERING
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.station import (
    USUAL_AXES,
    Actuator,
    Fixed,
    Gauge,
    Margin,
    StationRows,
    Stick,
    StickAxis,
    Switch,
    Twist,
    Unusable,
    Value,
    Velocity,
)
from firmware_bridge.units import SECOND

STANDSTILL_MPS: Final = 0.001
"""Speed below which a yaw rate gives no steering angle."""


def steer_for(speed_mps: float, yaw_rate_rad_s: float, base: DavisBase) -> float | None:
    """Return the inner front wheel's angle for a speed and a yaw rate, left positive; None at standstill."""
    if abs(speed_mps) < STANDSTILL_MPS:
        return None
    return steer_from_curvature(base, yaw_rate_rad_s / speed_mps)


def of_stick(stick: Stick, command: RarsMotion, robot: Robot[RarsGeometry]) -> RarsMotion:
    """Return the command for a stick; an unused axis leaves steering and lift target as they are."""
    limits = robot.geometry.limits
    side = stick.left if stick.turn is None else stick.turn
    return replace(
        command,
        speed_mps=(stick.forward or 0.0) * limits.speed_mps,
        steer_rad=command.steer_rad if side is None else side * math.radians(limits.steer_angle_deg),
        # A stick that moves the lift drops its target: it goes with a rate from where it is.
        lift_m=command.lift_m if stick.up is None else None,
        lift_rate_mps=(stick.up or 0.0) * limits.lift_rate_mps,
    )


def of_target(velocity: Velocity, command: RarsMotion, robot: Robot[RarsGeometry]) -> RarsMotion | Unusable:
    """Return the command for a velocity: forward speed, and the steering that gives the yaw rate."""
    if velocity.left_mps != 0.0:
        return Unusable("sideways", "this robot moves forward and backward only")
    speed, yaw_rate = velocity.forward_mps, velocity.yaw_rate_rad_s
    # Without a yaw rate the velocity is meant straight ahead.
    steer = 0.0 if yaw_rate is None else steer_for(speed, yaw_rate, robot.geometry.base)
    return replace(
        command, speed_mps=speed, steer_rad=command.steer_rad if steer is None else steer, lift_rate_mps=0.0
    )


def _lifted(command: RarsMotion, share: float, robot: Robot[RarsGeometry]) -> RarsMotion:
    return replace(command, lift_m=share * highest(robot.geometry.lift), lift_rate_mps=0.0)


def _forgotten(command: RarsMotion) -> RarsMotion:
    return replace(command, lift_m=None, lift_rate_mps=0.0)


def _twist(state: RarsState) -> Twist:
    return Twist(state.speed_mps, 0.0, state.yaw_rate_rad_s)


def _largest(robot: Robot[RarsGeometry]) -> Twist:
    limits = robot.geometry.limits
    return Twist(limits.speed_mps, 0.0, limits.speed_mps / limits.turn_radius_m)


def _steer_deg(seen: Snapshot[RarsMotion, RarsState]) -> float | None:
    return None if seen.body.steer_rad is None else math.degrees(seen.body.steer_rad)


def _margin_mm(_robot: Robot[RarsGeometry], seen: Snapshot[RarsMotion, RarsState]) -> float | None:
    return None if seen.body.margin_m is None else 1000.0 * seen.body.margin_m


def _least_mm(robot: Robot[RarsGeometry]) -> float | None:
    balance = robot.geometry.balance
    return None if balance is None else 1000.0 * balance.least_margin_m


STATION: Final[StationRows[RarsGeometry, RarsMotion, RarsState]] = StationRows(
    stick=of_stick,
    target=of_target,
    twist=_twist,
    forgotten=_forgotten,
    largest=_largest,
    meters_rolled=lambda robot: robot.geometry.base.wheel_radius_m,
    stop_button=2,
    up_button=3,
    axes=(*USUAL_AXES, StickAxis.UP),
    helm=True,  # thesis 4.3
    switches=(
        Switch(
            "detector",
            read=lambda command: command.detector,
            write=lambda command, on: replace(command, detector=on),
            relay=0,
            button=0,
            telemetry="DETECT",
        ),
        Switch(
            "headlamp",
            read=lambda command: command.headlamp,
            write=lambda command, on: replace(command, headlamp=on),
            relay=1,
            button=1,
            illuminates=True,
            telemetry="LAMP",
        ),
    ),
    actuators=(Actuator("lift", _lifted),),
    values=(
        Value("STEER", SECOND // 10, _steer_deg, "inner wheel, deg, left positive"),
        Value("ZPOS", SECOND // 5, lambda seen: seen.body.lift_m, "m above collapsed"),
    ),
    lifted="ZPOS",
    margin=Margin(_margin_mm, _least_mm, "mm", "zero-moment point inside the support"),
    gauges=(
        Gauge(
            STEERING,
            "deg",
            reading=lambda pinion, robot: math.degrees(steer_from_pinion(robot.geometry.base, pinion)),
            position=lambda angle, robot: pinion_from_steer(robot.geometry.base, math.radians(angle)),
        ),
        Gauge(
            SCREW,
            "m",
            reading=lambda screw, robot: height_from_screw(robot.geometry.lift, screw),
            position=lambda height, robot: screw_from_height(robot.geometry.lift, height),
        ),
    ),
    parameters=(
        Fixed("WHEEL_R", lambda robot: robot.geometry.base.wheel_radius_m, "m"),
        Fixed("TRACK_L", lambda robot: robot.geometry.base.rear_track_m, "m"),
        Fixed("BASE_L", lambda robot: robot.geometry.base.wheelbase_m, "m"),
        Fixed("KINGPIN_L", lambda robot: robot.geometry.base.kingpin_distance_m, "m"),
        Fixed("SPD_MAX", lambda robot: robot.geometry.limits.speed_mps, "m/s"),
        Fixed("ACC_MAX", lambda robot: robot.geometry.limits.acceleration_mps2, "m/s2"),
        Fixed("STR_MAX", lambda robot: robot.geometry.limits.steer_angle_deg, "deg"),
        Fixed("RAD_MIN", lambda robot: robot.geometry.limits.turn_radius_m, "m"),
        Fixed("LIFT_RETR", lambda robot: robot.geometry.limits.lift_retracted_m, "m"),
        Fixed("LIFT_RATE", lambda robot: robot.geometry.limits.lift_rate_mps, "m/s"),
    ),
)
