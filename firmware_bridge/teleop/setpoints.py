"""Set-point messages to axes and velocities, with the robot's signs: forward, left and up positive.

What is not a number, or beyond all sense, is refused here with a reason; what is merely too much is left to
the interlocks, which say so. MAVLink counts `y` to the right, yaw and `r` clockwise. What an axis or a
velocity means for a robot is its station's: this module knows none.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from firmware_bridge.mavlink.frames import Message, dialect
from firmware_bridge.teleop.station import Channel, Place, Stick, StickAxis, Twist, Unusable, Velocity

BODY_FRAMES: Final = frozenset(
    {dialect.MAV_FRAME_BODY_NED, dialect.MAV_FRAME_BODY_OFFSET_NED, dialect.MAV_FRAME_BODY_FRD}
)
"""Frames whose velocity is along the robot; 8 and 9 are the older names of 12."""
MAP_FRAMES: Final = frozenset({dialect.MAV_FRAME_LOCAL_NED, dialect.MAV_FRAME_LOCAL_OFFSET_NED})
"""Frames whose velocity is along the axes of the odometry; an offset is one of the position alone."""


@dataclass(frozen=True, slots=True)
class Carries:
    """Content of a set-point under its type mask."""

    level: bool
    """A velocity on the plane; without one it is a yaw rate alone."""
    vertical: bool
    turn: bool
    """A yaw rate."""
    heading: bool
    """A yaw angle: this bridge turns to none."""


_VERTICAL: Final = dialect.POSITION_TARGET_TYPEMASK_VZ_IGNORE
_TURN: Final = dialect.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE
_HEADING: Final = dialect.POSITION_TARGET_TYPEMASK_YAW_IGNORE
_FORCE: Final = dialect.POSITION_TARGET_TYPEMASK_FORCE_SET
"""The flag for an acceleration's meaning, without effect where that is left out: DroneKit sets it in 4039."""
_NO_PLACE_NO_ACCELERATION: Final = 0x01C7
_LEVEL: Final = dialect.POSITION_TARGET_TYPEMASK_VX_IGNORE | dialect.POSITION_TARGET_TYPEMASK_VY_IGNORE
_MASKS: Final = {
    _NO_PLACE_NO_ACCELERATION
    | (0 if vertical else _VERTICAL)
    | (0 if turn else _TURN)
    | (0 if heading else _HEADING): Carries(level=True, vertical=vertical, turn=turn, heading=heading)
    for vertical in (False, True)
    for turn in (False, True)
    for heading in (False, True)
} | {
    _NO_PLACE_NO_ACCELERATION | _LEVEL | _HEADING | (0 if vertical else _VERTICAL): Carries(
        level=False, vertical=vertical, turn=True, heading=False
    )
    for vertical in (False, True)
}
"""Type masks with a velocity and without place and acceleration: 1511 and 3559, 1479 and 2503 of MAVSDK and
MAVROS, 4039 of DroneKit; and with a yaw rate alone, 1535."""

_PLACE_X: Final = dialect.POSITION_TARGET_TYPEMASK_X_IGNORE
_PLACE_Y: Final = dialect.POSITION_TARGET_TYPEMASK_Y_IGNORE
_PLACE_Z: Final = dialect.POSITION_TARGET_TYPEMASK_Z_IGNORE
_VELOCITY_AND_ACCELERATION: Final = 0x01F8
_ABSURD: Final = 10.0
"""Multiple of the robot's limit that no operator means."""

RELEASED: Final = 0
"""Of RC_CHANNELS_OVERRIDE, channels 1 to 8: given back to the radio."""
KEPT: Final = 0xFFFF
"""Left as it is."""
_RELEASED_ABOVE: Final = 0xFFFE
_FIRST_OF_EXTENSIONS: Final = 9
"""From this channel on 0 leaves it as it is, and 65534 gives it back (common.xml)."""
_NEUTRAL_US, _FULL_US = 1500, 500
_LEAST_US, _MOST_US = 900, 2100
"""A receiver that has lost its transmitter sends less than 950, and no one's stick as much as that."""


def channels_of(message: Message, rows: Iterable[Channel]) -> dict[int, int | None] | Unusable:
    """Read these rows' channels of an RC_CHANNELS_OVERRIDE, in us; None: given back, left out: kept."""
    held: dict[int, int | None] = {}
    for row in rows:
        value: int = getattr(message, f"chan{row.number}_raw")
        extended = row.number >= _FIRST_OF_EXTENSIONS
        # From channel 9 on the meanings differ: 0 leaves it, 65534 gives it back (common.xml).
        if value == KEPT or (extended and value == RELEASED):
            continue
        if value == (_RELEASED_ABOVE if extended else RELEASED):
            held[row.number] = None
        elif _LEAST_US <= value <= _MOST_US:
            held[row.number] = value
        else:
            return Unusable(
                "channel", f"channel {row.number} = {value} us, neither 1000 to 2000 nor released"
            )
    return held


def stick_of_channels(
    channels: Mapping[int, int], rows: Iterable[Channel], dead_band: float
) -> tuple[Stick, str]:
    """Return the stick that these channels are, in us, and which is deflected; none: an axis not used."""
    shares: dict[StickAxis, float] = {}
    deflected = ""
    for row in rows:
        if row.number not in channels:
            continue
        microseconds = channels[row.number]
        share = (microseconds - _NEUTRAL_US) / _FULL_US
        shares[row.axis] = row.sign * min(max(share, -1.0), 1.0)
        if not deflected and abs(share) > dead_band:
            deflected = f"channel {row.number} stands at {microseconds} us: this robot wants {_NEUTRAL_US}"
    stick = Stick(
        forward=shares.get(StickAxis.FORWARD),
        left=shares.get(StickAxis.LEFT),
        turn=shares.get(StickAxis.TURN),
        up=None,
    )
    return stick, deflected


def place_of(message: Message) -> Place | Unusable | None:
    """Read a SET_POSITION_TARGET_LOCAL_NED with a place for a robot of one axis: x; None without a place."""
    mask = message.type_mask
    if mask & _PLACE_X:
        return None
    if (
        mask & _VELOCITY_AND_ACCELERATION != _VELOCITY_AND_ACCELERATION
        or not mask & _TURN
        or not mask & _HEADING
    ):
        return Unusable("mask", f"type mask {mask}: a place alone is 3576, or 3582 with x alone")
    if message.coordinate_frame != dialect.MAV_FRAME_LOCAL_NED:
        return Unusable("frame", f"frame {message.coordinate_frame}; a place is in frame 1")
    others = [value for value, unread in ((message.y, _PLACE_Y), (message.z, _PLACE_Z)) if not mask & unread]
    if not math.isfinite(message.x) or any(others):
        return Unusable("place", "one axis goes to x: a finite number, with y and z at 0")
    return Place(message.x)


def turns_alone(message: Message) -> bool:
    """Return whether a set-point carries a yaw rate, and no velocity."""
    # DroneKit sets the force bit in its masks, although it sends no acceleration.
    carries = _MASKS.get(message.type_mask & ~_FORCE)
    return carries is not None and not carries.level


def velocity_of(message: Message, largest: Twist, heading_rad: float | None = None) -> Velocity | Unusable:
    """Read a SET_POSITION_TARGET_LOCAL_NED of a robot whose limits are `largest`, and which heads there.

    To stand still is understood in any of these frames, with whatever heading beside it.
    """
    carries = _MASKS.get(message.type_mask & ~_FORCE)
    if message.coordinate_frame not in BODY_FRAMES | MAP_FRAMES:
        return Unusable("frame", f"frame {message.coordinate_frame}; only body frames 8, 9 and 12")
    if carries is None:
        return Unusable(
            "mask", f"type mask {message.type_mask}; only velocity with or without yaw rate (1511, 3559)"
        )
    yaw_rate = -message.yaw_rate if carries.turn else 0.0
    climb = message.vz if carries.vertical else 0.0
    vx, vy = (message.vx, message.vy) if carries.level else (0.0, 0.0)
    if not all(map(math.isfinite, (vx, vy, climb, yaw_rate))):
        return Unusable("not finite", "a velocity that is no finite number")
    # Before climb and heading are judged: a stop must not be refused for what stands beside it.
    if vx == vy == climb == yaw_rate == 0.0:
        return Velocity(0.0, 0.0, 0.0 if carries.turn else None)
    along: tuple[float, float] | Unusable = _along(message.coordinate_frame, (vx, vy), largest, heading_rad)
    if carries.heading:
        along = Unusable("heading", f"type mask {message.type_mask} requests a heading; send a yaw rate")
    elif climb != 0.0:
        along = Unusable("vertical", "this robot stays on its plane")
    if isinstance(along, Unusable):
        return along
    return _sane(Velocity(*along, yaw_rate if carries.turn else None), largest)


def _along(
    frame: int, velocity: tuple[float, float], largest: Twist, heading_rad: float | None
) -> tuple[float, float] | Unusable:
    """Return the velocity forward and left; one on the map is followed by a robot that can go any way."""
    vx, vy = velocity
    if frame in BODY_FRAMES:
        # MAVLink counts y to the right.
        return vx, 0.0 - vy  # of a zero no negative one
    if largest.left_mps == 0.0 or heading_rad is None:
        reason = "only body frames 8, 9 and 12: it cannot go sideways"
        return Unusable("frame", f"frame {frame}; {reason}")
    cosine, sine = math.cos(heading_rad), math.sin(heading_rad)
    # From north and east to forward and left, with the heading to the left.
    return vx * cosine - vy * sine, -vx * sine - vy * cosine


def _sane(velocity: Velocity, largest: Twist) -> Velocity | Unusable:
    forward, left, yaw_rate = velocity.forward_mps, velocity.left_mps, velocity.yaw_rate_rad_s or 0.0
    fastest = _ABSURD * math.hypot(largest.forward_mps, largest.left_mps)
    if math.hypot(forward, left) > fastest or abs(yaw_rate) > _ABSURD * largest.yaw_rate_rad_s:
        return Unusable(
            "absurd",
            f"{forward:.3g} m/s forward, {left:.3g} m/s left, {yaw_rate:.3g} rad/s counter-clockwise",
        )
    return velocity
