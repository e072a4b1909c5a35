"""The ways of driving, with their numbers: a row for each; and the decoding of a station's request.

There is no numbering that all stations read. Those built on pymavlink (MAVProxy, DroneKit) take a ground
rover's numbers for those of ArduPilot's Rover, whatever autopilot it names; MAVSDK takes those of anything
but ArduPilot for PX4's. So every station receives Rover's, as AVAILABLE_MODES lists them, until it has sent a
request in PX4's. Sources: ArduPilot, Rover/mode.h; PX4, px4_custom_mode.h; pymavlink,
mavutil.mode_string_v10; MAVSDK, core/flight_mode.cpp; mavlink.io, "Standard Modes Protocol".
"""

from dataclasses import dataclass
from enum import Enum
from typing import Final, NamedTuple

from firmware_bridge.mavlink.frames import Message, dialect


class DrivingMode(Enum):
    """The way of driving, by the name that an operator reads."""

    MANUAL = "Manual"
    """Driven by a stick, or by any motion command that is the newest."""
    GUIDED = "Guided"
    """Driven by set-points: a neutral stick does not count while they come, a deflected one takes over."""
    HOLD = "Hold"
    """It stands at standstill, and waits."""


def px4(main: int, sub: int = 0) -> int:
    """Return PX4's number of a main mode and its submode."""
    # PX4: main mode in bits 16 to 23, submode in bits 24 to 31 of custom_mode.
    return main << 16 | sub << 24


@dataclass(frozen=True, slots=True)
class ModeRow:
    """One way to be driven."""

    driving_mode: DrivingMode
    number: int
    """In HEARTBEAT, CURRENT_MODE and AVAILABLE_MODES, and in a request: as ArduPilot's Rover counts."""
    px4: int
    """The same for a station that has sent a request in PX4's numbers."""
    also: tuple[int, ...] = ()
    """More of PX4's numbers that ask for it."""
    flags: int = 0
    """MAV_MODE_FLAG of this way, beside the one of custom modes."""


_MAIN_MANUAL: Final = 1
_MAIN_AUTO: Final = 4
_LOITER: Final = 3
ROWS: Final = (
    ModeRow(
        DrivingMode.MANUAL,
        0,
        px4(_MAIN_MANUAL),
        (px4(2), px4(3)),  # ALTCTL and POSCTL: MAVSDK's ways to begin manual control
        flags=dialect.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED,
    ),
    ModeRow(DrivingMode.GUIDED, 15, px4(6), flags=dialect.MAV_MODE_FLAG_GUIDED_ENABLED),
    ModeRow(DrivingMode.HOLD, 4, px4(_MAIN_AUTO, _LOITER)),
)
BY_DRIVING_MODE: Final = {row.driving_mode: row for row in ROWS}
_BY_NUMBER: Final = {row.number: row.driving_mode for row in ROWS}
_BY_PX4: Final = {number: row.driving_mode for row in ROWS for number in (row.px4, *row.also)}
_FIRST_OWN: Final = 20
_OWN: Final[tuple[int, ...]] = (0, *range(_FIRST_OWN, 1 << 6))
"""The numbers of the robot's own modes by their places, 0 the whole robot's.

Rover ends at 16, and PX4 with its main modes, which come in the same parameter, at 11. A request for one of
theirs must not select one of these.
"""
_WHOLE: Final = 1 << 16
"""PX4's numbers are not below this where they are not divided into main mode and submode."""


class ModeRequest(NamedTuple):
    """The request in a station's numbers."""

    driving_mode: DrivingMode
    own: int | None
    """The place of one of the robot's own modes; None where it is to stay in the one that it has."""
    px4: bool
    """True where they are PX4's."""


def requested(main: int, sub: int, own: int) -> ModeRequest | None:
    """Return what DO_SET_MODE's parameters 2 and 3 ask of a robot with so many modes; None for none of them.

    The robot's own modes, after a failed actuator, are counted from 20; 0 is that of the whole robot.
    """
    if main in _OWN[:own]:
        return ModeRequest(DrivingMode.MANUAL, _OWN.index(main), px4=False)
    if main in _BY_NUMBER and sub == 0:
        return ModeRequest(_BY_NUMBER[main], None, px4=False)
    # MAVSDK sends main and sub mode as two parameters, SET_MODE both in one number.
    whole = main if main >= _WHOLE else px4(main, sub)
    driving_mode = _BY_PX4.get(whole)
    if driving_mode is not None:
        return ModeRequest(driving_mode, 0 if whole == px4(_MAIN_MANUAL) else None, px4=True)
    place = whole >> 24
    if whole == px4(_MAIN_MANUAL, place) and place < own:
        return ModeRequest(DrivingMode.MANUAL, place, px4=True)
    return None


def number_of(driving_mode: DrivingMode, own: int) -> int:
    """Return the number for every station; `own` is the place of the robot's own mode, 0 the whole."""
    return number_of_own(own) if driving_mode is DrivingMode.MANUAL else BY_DRIVING_MODE[driving_mode].number


def number_of_own(place: int) -> int:
    """Return the number of one of the robot's own modes by its place; place 0 is the whole robot."""
    return _OWN[place]


def in_px4(number: int) -> int:
    """Return a number for every station as PX4 would count it; own modes are submodes of Manual."""
    driving_mode = _BY_NUMBER.get(number)
    return (
        px4(_MAIN_MANUAL, _OWN.index(number)) if driving_mode is None else BY_DRIVING_MODE[driving_mode].px4
    )


def listed(modes: tuple[str, ...]) -> list[Message]:
    """Return AVAILABLE_MODES, one for each; `modes` are the robot's own, the first the whole robot's."""
    rows = [(row.driving_mode.value, row.number, 0) for row in ROWS]
    rows += [
        (name.replace("_", " ").capitalize(), _OWN[place], dialect.MAV_MODE_PROPERTY_ADVANCED)
        for place, name in enumerate(modes)
        if name
    ]
    return [
        dialect.MAVLink_available_modes_message(
            len(rows),
            place,
            dialect.MAV_STANDARD_MODE_NON_STANDARD,
            number,
            properties,
            name[:_NAME].encode("ascii", "replace"),
        )
        for place, (name, number, properties) in enumerate(rows, 1)
    ]


_NAME: Final = 34
"""Letters of a mode's name, before its NUL."""
CARRIERS: Final = frozenset(
    {
        dialect.MAVLINK_MSG_ID_HEARTBEAT,
        dialect.MAVLINK_MSG_ID_CURRENT_MODE,
        dialect.MAVLINK_MSG_ID_AVAILABLE_MODES,
    }
)
"""Messages with a mode's number in `custom_mode`."""
