"""Period of each message, a row for each, for a network and for a narrow link; and a robot's parameters."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final

from firmware_bridge.mavlink.frames import Message, dialect
from firmware_bridge.mavlink.parameters import Parameter
from firmware_bridge.mavlink.schedule import Schedule
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.operator_link import TelemetryProfile
from firmware_bridge.teleop.station import AnyStation, AnyValue, Fixed, Value
from firmware_bridge.teleop.telemetry import (
    TelemetryContext,
    attitude,
    battery,
    current_mode,
    currents,
    distances,
    global_position,
    heartbeat,
    home,
    hud,
    landed,
    link,
    modes_monitor,
    named,
    no_gps,
    odometry,
    position,
    speeds,
    switches,
    system,
)
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

_OVERHEAD: Final = 12
"""Of a frame of MAVLink 2 without a signature."""
_ARRAY_HEADER: Final = 20
_BITS_A_BYTE: Final = 10
"""Line bits for one byte on a serial line: a radio's bandwidth is given as the line's rate."""
PACKET: Final[Nanoseconds] = SECOND // 20
"""Period of the packets of A. P. Das, PhD thesis, IIT Delhi, 2018, 4.1."""
FASTEST_HZ: Final = 20.0
"""Highest rate that a parameter sets."""
_SHARE: Final = 0.5
"""Of the bandwidth, for telemetry: half of it is left to commands, answers, lists and the other direction."""


@dataclass(frozen=True, slots=True)
class Stream:
    """One message that is sent by the clock."""

    number: int
    period: Nanoseconds
    encode: Callable[[TelemetryContext], Iterable[Message]]
    title: str
    size: int
    """Size in bytes on the link, all messages of one turn."""
    slow: Nanoseconds
    """Its period where the link is narrow."""
    watched: Callable[[TelemetryContext], object] | None = None
    """The value whose change makes it due at once."""
    packet: bool = False
    """True for a field of the packet that the profile `thesis` sends whole."""


class Telemetry:
    """The streams' messages at one instant, each made once, however many places it goes to."""

    __slots__ = ("_context", "_made", "_streams")

    def __init__(self, streams: tuple[Stream, ...], context: TelemetryContext) -> None:
        self._streams: Final = streams
        self._context: Final = context
        self._made: Final[dict[int, list[Message]]] = {}

    def changed(self, values: dict[int, object]) -> list[int]:
        """Return the streams that must not wait for their turn; `values` holds their last watched values."""
        changed: list[int] = []
        for place, stream in enumerate(self._streams):
            if stream.watched is not None:
                seen = stream.watched(self._context)
                if values.setdefault(place, seen) != seen:
                    values[place] = seen
                    changed.append(place)
        return changed

    def messages(self, changed: list[int], due: list[int]) -> list[Message]:
        """Return the messages of these streams, in the streams' order."""
        places = due if not changed else sorted({*changed, *due})
        messages: list[Message] = []
        for place in places:
            made = self._made.get(place)
            if made is None:
                made = self._made[place] = list(self._streams[place].encode(self._context))
            messages += made
        return messages


def _stream(
    number: int,
    period: Nanoseconds,
    encode: Callable[[TelemetryContext], Iterable[Message]],
    title: str,
    *,
    slow: Nanoseconds | None = None,
    size: int | None = None,
    times: int = 1,
    watched: Callable[[TelemetryContext], object] | None = None,
    packet: bool = False,
) -> Stream:
    """Return a row: its period on a narrow link is five times as long, but not above a second for that.

    `times`: so many messages in one turn. Its size is that of a frame of MAVLink 2 with its whole payload; of
    those that end in zeros it stands in the row.
    """
    each = _OVERHEAD + (dialect.mavlink_map[number].unpacker.size if size is None else size)
    usual = max(period, min(5 * period, SECOND))
    return Stream(
        number, period, encode, title, times * each, usual if slow is None else slow, watched, packet
    )


def streams_of(robot: AnyRobot, station: AnyStation) -> tuple[Stream, ...]:
    """Return one robot's streams in the order of sending: heartbeat, then the fastest first.

    On a link too narrow for all of it, by the robot file, the rows' slow periods count; on one too narrow for
    those, too, all but the heartbeat wait so much longer that it fits.
    """
    rows = list(map(PROFILES[robot.operator.telemetry.profile], _rows(robot, station)))
    bandwidth = robot.operator.bandwidth_bit_s
    # Ten bits a byte: start bit, eight data bits, stop bit.
    if bandwidth is None or load(rows) <= (room := bandwidth / _BITS_A_BYTE * _SHARE):
        return _ordered(rows)
    slow = [replace(row, period=row.slow) for row in rows]
    # The heartbeat keeps its second, as stations lose a robot without it; all else waits longer.
    stretch = max(load(slow[1:]) / max(room - load(slow[:1]), 1.0), 1.0)
    stretched = [replace(row, period=min(round(row.slow * stretch), NEVER)) for row in slow[1:]]
    return _ordered([slow[0], *stretched])


def _as_packet(row: Stream) -> Stream:
    """Return the row at the packet's rate, if it has a field of the packet."""
    return replace(row, period=min(row.period, PACKET)) if row.packet else row


PROFILES: Final[Mapping[TelemetryProfile, Callable[[Stream], Stream]]] = MappingProxyType(
    {TelemetryProfile.USUAL: lambda row: row, TelemetryProfile.THESIS: _as_packet}
)
"""What each profile makes of a row."""


def load(rows: Iterable[Stream]) -> float:
    """Return the bytes a second that these rows put on the link."""
    return sum(row.size * SECOND / row.period for row in rows if row.period < NEVER)


def narrowest(bytes_s: float) -> float:
    """Return the bandwidth, bit/s, from which on a link is wide enough for so many bytes of telemetry."""
    return bytes_s / _SHARE * _BITS_A_BYTE


def _ordered(rows: list[Stream]) -> tuple[Stream, ...]:
    return (rows[0], *sorted(rows[1:], key=lambda row: row.period))


def _rows(robot: AnyRobot, station: AnyStation) -> list[Stream]:
    """Return the rows at their usual periods, the heartbeat first."""
    switched = ", ".join(switch.telemetry for switch in station.switches if switch.telemetry)
    axes = len(robot.axes)
    rows: list[Stream] = [
        _stream(
            dialect.MAVLINK_MSG_ID_ODOMETRY,
            SECOND // 20,
            odometry,
            "pose, speed and yaw rate",
            slow=SECOND // 2,
            packet=True,
        ),
        _stream(dialect.MAVLINK_MSG_ID_LOCAL_POSITION_NED, SECOND // 20, position, "X, Y"),
        _stream(dialect.MAVLINK_MSG_ID_ATTITUDE, SECOND // 20, attitude, "heading"),
        _stream(
            dialect.MAVLINK_MSG_ID_WHEEL_DISTANCE, SECOND // 5, distances, "m, in the order of the wheels"
        ),
        *(_stream_of(value) for value in (*station.values, *_margin(station, robot))),
        _stream(
            dialect.MAVLINK_MSG_ID_DEBUG_FLOAT_ARRAY,
            SECOND // 10,
            speeds,
            "wheels: units a second",
            size=_ARRAY_HEADER + 4 * axes,
            packet=True,
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT,
            SECOND // 5,
            currents,
            "I1, I2, ...: A, all axes",
            times=axes,
            packet=True,
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT,
            SECOND,
            link,
            "of the station in control: RTT, round trip, s; AGE, of its newest command, s; LOSS, share "
            "of its frames",
            times=3,
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_INT,
            SECOND // 2,
            switches,
            f"{switched}: 0 or 1",
            times=len(station.switches),
        ),
        _stream(dialect.MAVLINK_MSG_ID_SYS_STATUS, SECOND, system, "voltage, health, corrupt frames, faults"),
        _stream(
            dialect.MAVLINK_MSG_ID_EXTENDED_SYS_STATE,
            SECOND,
            landed,
            "in the air while armed, as an armed rover of PX4 reports",
            watched=lambda context: context.snapshot.facts.armed,
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_BATTERY_STATUS,
            2 * SECOND,
            battery,
            "voltage, sum of the currents",
            packet=True,
        ),
        _stream(dialect.MAVLINK_MSG_ID_VFR_HUD, SECOND, hud, "speed, heading in degrees"),
        _stream(
            dialect.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
            SECOND,
            global_position,
            "heading and velocity; latitude and longitude 0: unknown",
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_CURRENT_MODE,
            2 * SECOND,
            current_mode,
            "Manual, Guided or Hold",
            watched=lambda context: context.custom_mode,
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_AVAILABLE_MODES_MONITOR,
            5 * SECOND,
            modes_monitor,
            "modes never change",
        ),
        _stream(dialect.MAVLINK_MSG_ID_GPS_RAW_INT, 5 * SECOND, no_gps, "no GPS"),
        _stream(dialect.MAVLINK_MSG_ID_HOME_POSITION, 5 * SECOND, home, "origin of the odometry: 0, 0"),
    ]
    lacking = {
        dialect.MAVLINK_MSG_ID_WHEEL_DISTANCE: station.meters_rolled is None,
        dialect.MAVLINK_MSG_ID_NAMED_VALUE_INT: not switched,
        dialect.MAVLINK_MSG_ID_BATTERY_STATUS: robot.battery is None,
    }
    first = _stream(
        dialect.MAVLINK_MSG_ID_HEARTBEAT,
        SECOND,
        heartbeat,
        "rover, armed or not, mode, status",
        watched=lambda context: (context.base_mode, context.custom_mode),
    )
    return [first, *(row for row in rows if not lacking.get(row.number))]


def _margin(station: AnyStation, robot: AnyRobot) -> Iterator[AnyValue]:
    """Yield the margin as a value, where the robot has one."""
    margin = station.margin_of(robot)
    if margin is not None:
        title = f"{margin.unit}, {margin.title}"
        yield Value("MARGIN", SECOND // 5, lambda seen: margin.read(robot, seen), title)


def _stream_of(value: AnyValue) -> Stream:
    def encode(context: TelemetryContext) -> tuple[Message, ...]:
        number = value.read(context.snapshot)
        return () if number is None else (named(context.boot_ms, value.name, number),)

    title = f"{value.name}: {value.title}"
    return _stream(dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT, value.period, encode, title, packet=True)


def parameters_of(
    robot: AnyRobot, fixed: tuple[Fixed[Any], ...], schedule: Schedule
) -> tuple[Parameter, ...]:
    """Return one robot's parameters: its type's, then those that all have; ValueError where a name is twice.

    The rates are first those of the schedule. Limits are read-only on purpose: the interlocks' values are
    changed in the robot file, by a person near the robot.
    """
    rows = (*(Parameter(row.name, row.value(robot), row.unit) for row in fixed), *_common(robot, schedule))
    names = [row.name for row in rows]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"station: parameters stand twice: {', '.join(twice)}")
    return rows


def _common(robot: AnyRobot, schedule: Schedule) -> tuple[Parameter, ...]:
    return (
        Parameter("CMD_TMO", robot.operator.silent_ms / 1000.0, "s"),
        Parameter("CYCLE", robot.cycle_ms / 1000.0, "s"),
        *(() if robot.battery is None else (Parameter("BAT_VLOW", robot.battery.low_v, "V"),)),
        Parameter("MAV_SYSID", float(robot.operator.system_id), ""),
        Parameter("MAV_COMPID", float(robot.operator.component_id), ""),
        _rate("RATE_ODOM", dialect.MAVLINK_MSG_ID_ODOMETRY, schedule),
        _rate("RATE_POS", dialect.MAVLINK_MSG_ID_LOCAL_POSITION_NED, schedule),
        _rate("RATE_ATT", dialect.MAVLINK_MSG_ID_ATTITUDE, schedule),
    )


def _rate(name: str, stream: int, schedule: Schedule) -> Parameter:
    period = schedule.default(stream)
    first = 0.0 if period is None else SECOND / period
    return Parameter(name, first, "Hz", (0.0, FASTEST_HZ), stream)
