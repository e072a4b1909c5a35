"""Set-point messages to the robot's words: forward and left positive, metres, radians. It judges no limit.

What is not a number, or beyond all sense, is refused here with a reason; what is merely too much is left to
the interlocks, which say so. MAVLink counts yaw and `r` clockwise, the robot counter-clockwise.

MANUAL_CONTROL: `x` is the speed, full stick the robot's limit; `r` (or `y` where `r` is unused) the
steering, full stick the largest angle; `z` is the lift's rate, and counts only while button 3 is held:
stations rest `z` at 0 or at 500, and neither may move the platform. Buttons: 0 detector, 1 headlamp,
2 emergency stop, 3 lift.
"""

import math
from dataclasses import dataclass
from typing import Final

from firmware_bridge.motion.davis import steer_from_curvature
from firmware_bridge.robot import Base, Robot
from firmware_bridge.teleop.mavlink import Message, dialect

FULL_STICK: Final = 1000
UNUSED: Final = 0x7FFF
LIFT_DEAD_BAND: Final = 50
"""Of `z`; a hand that rests on a stick does not hold it at zero."""

DETECTOR_BUTTON: Final = 1 << 0
HEADLAMP_BUTTON: Final = 1 << 1
STOP_BUTTON: Final = 1 << 2
LIFT_BUTTON: Final = 1 << 3

BODY_FRAMES: Final = frozenset(
    {dialect.MAV_FRAME_BODY_NED, dialect.MAV_FRAME_BODY_OFFSET_NED, dialect.MAV_FRAME_BODY_FRD}
)
"""Frames whose velocity is along the robot; 8 and 9 are the older names of 12."""

_NOT_VERTICAL: Final = dialect.POSITION_TARGET_TYPEMASK_VZ_IGNORE
_NO_YAW_RATE: Final = dialect.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE
VELOCITY_AND_YAW_RATE: Final = 0x05E7
VELOCITY_ONLY: Final = VELOCITY_AND_YAW_RATE | _NO_YAW_RATE
_MASKS: Final = frozenset(
    {
        VELOCITY_AND_YAW_RATE,
        VELOCITY_ONLY,
        VELOCITY_AND_YAW_RATE & ~_NOT_VERTICAL,
        VELOCITY_ONLY & ~_NOT_VERTICAL,
    }
)
"""Type masks that say no more than a forward speed and a yaw rate; 1479 is what MAVSDK sends."""

STANDSTILL_MPS: Final = 0.001
"""Below this speed a yaw rate tells no steering angle."""
_ABSURD: Final = 10.0
"""Times the robot's limit; nobody who drives means it."""


@dataclass(frozen=True, slots=True)
class Setpoint:
    """One wish for motion; None leaves the steering where it is."""

    speed_mps: float
    steer_rad: float | None
    lift_rate_mps: float = 0.0


@dataclass(frozen=True, slots=True)
class Unusable:
    """Why a message is no wish; `key` is the same for the same kind of fault."""

    key: str
    reason: str


def of_stick(message: Message, robot: Robot) -> Setpoint | Unusable:
    """Read the axes of a MANUAL_CONTROL."""
    lift_used = bool(message.buttons & LIFT_BUTTON)
    x: int = message.x
    y: int = message.y
    r: int = message.r
    z: int = message.z if lift_used else UNUSED
    for name, value in (("x", x), ("y", y), ("r", r), ("z", z)):
        if abs(value) > FULL_STICK and value != UNUSED:
            return Unusable("stick", f"MANUAL_CONTROL refused: {name} = {value} is beyond +-{FULL_STICK}")
    side = r if r != UNUSED else y
    limits = robot.limits
    return Setpoint(
        _share(x) * limits.speed_mps,
        None if side == UNUSED else -_share(side) * math.radians(limits.steer_angle_deg),
        _share(z, LIFT_DEAD_BAND) * limits.lift_rate_mps,
    )


def of_target(message: Message, robot: Robot) -> Setpoint | Unusable:
    """Read a SET_POSITION_TARGET_LOCAL_NED: forward speed, and the steering that gives the yaw rate."""
    mask = message.type_mask
    name = "SET_POSITION_TARGET_LOCAL_NED refused"
    if message.coordinate_frame not in BODY_FRAMES:
        return Unusable("frame", f"{name}: frame {message.coordinate_frame}; only body frames 8, 9 and 12")
    if mask not in _MASKS:
        return Unusable(
            "mask", f"{name}: type mask {mask}; only velocity with or without yaw rate (1511, 3559)"
        )
    yaw_rate = 0.0 if mask & _NO_YAW_RATE else -message.yaw_rate
    climb = 0.0 if mask & _NOT_VERTICAL else message.vz
    if not all(map(math.isfinite, (message.vx, message.vy, climb, yaw_rate))):
        return Unusable("not finite", f"{name}: a velocity that is no finite number")
    if message.vy != 0.0 or climb != 0.0:
        return Unusable("sideways", f"{name}: this robot moves forward and backward only")
    fastest = _ABSURD * robot.limits.speed_mps
    if abs(message.vx) > fastest or abs(yaw_rate) > fastest / robot.limits.turn_radius_m:
        return Unusable("absurd", f"{name}: {message.vx:.3g} m/s, {yaw_rate:.3g} rad/s left")
    return Setpoint(message.vx, 0.0 if mask & _NO_YAW_RATE else steer_for(message.vx, yaw_rate, robot.base))


def steer_for(speed_mps: float, yaw_rate_rad_s: float, base: Base) -> float | None:
    """Return the inner front wheel's angle for a speed and a yaw rate, left positive; None at standstill."""
    if abs(speed_mps) < STANDSTILL_MPS:
        return None
    return steer_from_curvature(base, yaw_rate_rad_s / speed_mps)


def _share(axis: int, dead_band: int = 0) -> float:
    return 0.0 if axis == UNUSED or abs(axis) <= dead_band else axis / FULL_STICK
