"""Datagrams that no operator should send, one of each kind: what the bridge must live through."""

import math
from collections.abc import Callable
from enum import StrEnum
from typing import Final

from firmware_bridge.mavlink.frames import Codec, Message, dialect

_ANOTHER_SYSTEM: Final = 77
_FORCE: Final = 21196


class Stray(StrEnum):
    """Kind of error in the datagram."""

    GARBAGE = "garbage"
    """Garbage bytes, no MAVLink."""
    CORRUPT = "corrupt"
    """A set-point with one wrong bit."""
    NOT_A_NUMBER = "not_a_number"
    """A set-point whose speed is NaN."""
    ABSURD = "absurd"
    """100 m/s."""
    SIDEWAYS = "sideways"
    """A velocity across the robot."""
    MAP_FRAME = "map_frame"
    """A velocity in a frame that the robot does not follow."""
    OTHER_ROBOT = "other_robot"
    """A set-point for another system."""
    UNKNOWN_COMMAND = "unknown_command"
    """Return to launch."""
    FORCED_ARM = "forced_arm"
    """Arming without checks."""
    RAISED_LIMIT = "raised_limit"
    """A parameter that would raise the speed limit."""


def velocity(
    system: int,
    component: int,
    vx: float,
    yaw_rate: float = 0.0,
    *,
    vy: float = 0.0,
    frame: int = 8,
    at_ms: int = 0,
) -> Message:
    """Return a SET_POSITION_TARGET_LOCAL_NED with a velocity and a yaw rate, mask 1511; SI, NED.

    `at_ms`: the station's clock; without it the message carries no time.
    """
    # Ignored: position, vz, acceleration and yaw; vx, vy and the yaw rate count.
    mask = 1511
    rest = (0.0,) * 4
    return dialect.MAVLink_set_position_target_local_ned_message(
        at_ms, system, component, frame, mask, 0.0, 0.0, 0.0, vx, vy, *rest, 0.0, yaw_rate
    )


def command(system: int, component: int, number: int, *params: float, confirmation: int = 0) -> Message:
    """Return a COMMAND_LONG; parameters that are not given are 0."""
    seven = (*params, *(0.0,) * (7 - len(params)))
    return dialect.MAVLink_command_long_message(system, component, number, confirmation, *seven)


def datagram(stray: Stray, codec: Codec, system: int, component: int) -> bytes:
    """Return the datagram, addressed to this robot where its kind has an address."""
    if stray is Stray.GARBAGE:
        return b"\xfd\xff\x00\x00\xfe\x08 this is no MAVLink \x00\xfd\xfd\xfe"
    frame = bytearray(codec.encode(_MESSAGES[stray](system, component)))
    if stray is Stray.CORRUPT:
        # Within the payload: frame and length are right, and the checksum is not.
        frame[_WRONG_AT] ^= 0x10
    return bytes(frame)


_WRONG_AT: Final = 20

_MESSAGES: Final[dict[Stray, Callable[[int, int], Message]]] = {
    Stray.CORRUPT: lambda s, c: velocity(s, c, 0.5),
    Stray.NOT_A_NUMBER: lambda s, c: velocity(s, c, math.nan),
    Stray.ABSURD: lambda s, c: velocity(s, c, 100.0),
    Stray.SIDEWAYS: lambda s, c: velocity(s, c, 0.2, vy=0.2),
    Stray.MAP_FRAME: lambda s, c: velocity(s, c, 0.2, frame=dialect.MAV_FRAME_LOCAL_NED),
    Stray.OTHER_ROBOT: lambda _, c: velocity(_ANOTHER_SYSTEM, c, 0.5),
    Stray.UNKNOWN_COMMAND: lambda s, c: command(s, c, dialect.MAV_CMD_NAV_RETURN_TO_LAUNCH),
    Stray.FORCED_ARM: lambda s, c: command(s, c, dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, _FORCE),
    Stray.RAISED_LIMIT: lambda s, c: dialect.MAVLink_param_set_message(
        s, c, b"SPD_MAX", 5.0, dialect.MAV_PARAM_TYPE_REAL32
    ),
}
