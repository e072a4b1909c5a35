"""Messages that ground stations receive and may send: the operator's link, from its tables."""

from collections.abc import Iterator
from typing import Final, TypeAlias

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.mavlink.lacking import LACKING
from firmware_bridge.mavlink.modes import ROWS as MODES
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.robot_types import find, robot_type_of
from firmware_bridge.teleop.commands import ROWS as COMMANDS
from firmware_bridge.teleop.driving import AXES
from firmware_bridge.teleop.station import USUAL_CHANNELS, AnyStation, Stick, StickAxis
from firmware_bridge.teleop.streams import load, narrowest, streams_of
from firmware_bridge.units import Nanoseconds, to_seconds
from validation.pages.safety import shipped

DIRECTIONS: Final = {
    (StickAxis.FORWARD, 1): "forward",
    (StickAxis.FORWARD, -1): "backward",
    (StickAxis.LEFT, 1): "to the left",
    (StickAxis.LEFT, -1): "to the right",
    (StickAxis.TURN, 1): "counter-clockwise",
    (StickAxis.TURN, -1): "clockwise",
}
"""Direction of an axis for more microseconds, by its sign."""
Cells: TypeAlias = tuple[str, ...]
RADIO_BIT_S: Final = 57_600
MODE_HEADINGS: Final = ("mode", "number", "in PX4's numbers: main, sub", "also requested by")
STREAM_HEADINGS: Final = ("message", "on a network", f"on {RADIO_BIT_S} bit/s", "content")
COMMAND_HEADINGS: Final = ("command", "number", "accepted from", "effect")
STICK_HEADINGS: Final = ("robot", *(name for name, _ in AXES.values()), "buttons")
CHANNEL_HEADINGS: Final = ("channel", "axis", "2000 us is")


def modes() -> Iterator[Cells]:
    """Yield the modes of control, and the requests for them."""
    for row in MODES:
        also = "; ".join(map(_in_parts, row.also)) or "-"
        yield (row.driving_mode.value, str(row.number), _in_parts(row.px4), also)


def _in_parts(number: int) -> str:
    return f"{number >> 16 & 0xFF}, {number >> 24}"


def channels() -> Iterator[Cells]:
    """Yield the channels of RC_CHANNELS_OVERRIDE."""
    for row in USUAL_CHANNELS:
        yield (str(row.number), row.axis.name.lower(), DIRECTIONS[row.axis, row.sign])


def sticks() -> Iterator[Cells]:
    """Yield what the axes and buttons of MANUAL_CONTROL do, by robot."""
    for robot_type, robot in shipped():
        station, rest = robot_type.station, robot_type.standstill
        still = station.stick(Stick(forward=0.0, left=0.0, turn=0.0, up=None), rest, robot)
        across = station.stick(Stick(forward=0.0, left=0.5, turn=0.0, up=None), rest, robot)
        axes = {
            StickAxis.FORWARD: "forward",
            StickAxis.LEFT: "to the right" if across != still else "as r, where r is not used",
            StickAxis.TURN: "clockwise",
            StickAxis.UP: "up" if station.up_button is None else f"up, with button {station.up_button}",
        }
        cells = [axes[axis] if axis in station.axes else "-" for axis in AXES]
        yield (
            robot.name,
            *cells,
            "; ".join(f"{number} {what}" for number, what in sorted(_buttons(station))),
        )


def of_place() -> str:
    """Return the robots that go to a place by a set-point."""
    return ", ".join(robot.name for kind, robot in shipped() if kind.station.place is not None)


def _buttons(station: AnyStation) -> Iterator[tuple[int, str]]:
    if station.stop_button is not None:
        yield station.stop_button, "emergency stop"
    if station.up_button is not None:
        yield station.up_button, "z counts"
    for switch in station.switches:
        if switch.button is not None:
            yield switch.button, switch.name


def streams() -> Iterator[Cells]:
    """Yield the telemetry messages and their periods, of the first robot that is shipped."""
    usual, slow = streams_of(_robot(None), _station()), streams_of(_robot(RADIO_BIT_S), _station())
    narrow = {(row.number, row.title): row.period for row in slow}
    for row in usual:
        name = dialect.mavlink_map[row.number].msgname
        yield (name, _each(row.period), _each(narrow[row.number, row.title]), row.title)


def loads() -> tuple[float, float]:
    """Return the bytes a second that this makes at most, on a network and on the radio."""
    return load(streams_of(_robot(None), _station())), load(streams_of(_robot(RADIO_BIT_S), _station()))


def commands() -> Iterator[Cells]:
    """Yield the commands that are known."""
    names = dialect.enums["MAV_CMD"]
    for row in COMMANDS:
        name = names[row.command].name if row.command in names else "MAV_CMD_REQUEST_OPERATOR_CONTROL"
        yield (name.removeprefix("MAV_CMD_"), str(row.command), _of_whom(anyone=row.anyone), row.does)


def lacking() -> str:
    """Return the messages of protocols that there are not."""
    return ", ".join(dialect.mavlink_map[number].msgname for number in LACKING)


def profile_loads() -> dict[str, float]:
    """Return the bytes a second of RARS at most, usual and whole, and the least bit rate for the whole."""
    usual, whole = (
        load(streams_of(robot, robot_type_of(robot).station)) for robot in map(find, ("rars", "rars+thesis"))
    )
    return {"usual": usual, "whole": whole, "least": narrowest(whole)}


def _of_whom(*, anyone: bool) -> str:
    return "any station *" if anyone else "station in control"


def _each(period: Nanoseconds) -> str:
    return f"{to_seconds(period):.3g} s"


def _talker() -> tuple[AnyRobotType, AnyRobot]:
    """Return the shipped robot whose station has the most values: the page shows its own rows."""
    return max(shipped(), key=lambda one: len(one[0].station.values) + len(one[0].station.switches))


def _robot(bandwidth_bit_s: int | None) -> AnyRobot:
    _, robot = _talker()
    return robot.discriminated_by(bandwidth_bit_s)


def _station() -> AnyStation:
    robot_type, _ = _talker()
    return robot_type.station
