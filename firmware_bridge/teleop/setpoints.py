"""Set-point messages to axes and velocities, with the robot's signs: forward, left and up positive.

What is not a number, or beyond all sense, is refused here with a reason; what is merely too much is left to
the interlocks, which say so. MAVLink counts `y` to the right, yaw and `r` clockwise. What an axis or a
velocity means for a robot is its station's: this module knows none.

MANUAL_CONTROL's `z` counts only while the station's button for it is held: ground stations rest `z` at 0 or
at 500, and neither may move anything.
"""

import math
from typing import Final

from firmware_bridge.teleop.mavlink import Message, dialect
from firmware_bridge.teleop.station import Stick, Twist, Unusable, Velocity

FULL_STICK: Final = 1000
UNUSED: Final = 0x7FFF

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
"""Type masks that say no more than a velocity and a yaw rate; 1479 is what MAVSDK sends."""

_ABSURD: Final = 10.0
"""Times the robot's limit; nobody who drives means it."""


def pressed(buttons: int, button: int | None) -> bool:
    """Tell whether a button, counted from 0, is among these bits; a robot without it never has it pressed."""
    return button is not None and bool(buttons >> button & 1)


def stick_of(message: Message, *, up: bool, dead_band: float) -> Stick | Unusable:
    """Read the axes of a MANUAL_CONTROL; `up`: its z counts, beyond the dead band."""
    x: int = message.x
    y: int = message.y
    r: int = message.r
    z: int = message.z if up else UNUSED
    for name, value in (("x", x), ("y", y), ("r", r), ("z", z)):
        if abs(value) > FULL_STICK and value != UNUSED:
            return Unusable("stick", f"{name} = {value} is beyond +-{FULL_STICK}")
    left, turn, raised = _share(y), _share(r), _share(z)
    return Stick(
        forward=_share(x),
        left=None if left is None else -left,
        turn=None if turn is None else -turn,
        up=None if raised is None or abs(raised) <= dead_band else raised,
    )


def velocity_of(message: Message, largest: Twist) -> Velocity | Unusable:
    """Read a SET_POSITION_TARGET_LOCAL_NED of a robot whose limits are `largest`."""
    mask = message.type_mask
    if message.coordinate_frame not in BODY_FRAMES:
        return Unusable("frame", f"frame {message.coordinate_frame}; only body frames 8, 9 and 12")
    if mask not in _MASKS:
        return Unusable("mask", f"type mask {mask}; only velocity with or without yaw rate (1511, 3559)")
    yaw_rate = 0.0 if mask & _NO_YAW_RATE else -message.yaw_rate
    climb = 0.0 if mask & _NOT_VERTICAL else message.vz
    if not all(map(math.isfinite, (message.vx, message.vy, climb, yaw_rate))):
        return Unusable("not finite", "a velocity that is no finite number")
    if climb != 0.0:
        return Unusable("vertical", "this robot stays on its plane")
    fastest = _ABSURD * math.hypot(largest.forward_mps, largest.left_mps)
    forward, left = message.vx, 0.0 - message.vy  # of a zero no negative one
    if math.hypot(forward, left) > fastest or abs(yaw_rate) > _ABSURD * largest.yaw_rate_rad_s:
        return Unusable(
            "absurd",
            f"{forward:.3g} m/s forward, {left:.3g} m/s left, {yaw_rate:.3g} rad/s counter-clockwise",
        )
    return Velocity(forward, left, None if mask & _NO_YAW_RATE else yaw_rate)


def _share(axis: int) -> float | None:
    return None if axis == UNUSED else axis / FULL_STICK
