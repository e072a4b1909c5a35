"""What the operator is told and how often: one row for each message.

The robot counts left, up and counter-clockwise positive; MAVLink's NED and FRD frames count right, down and
clockwise: y, yaw and yaw rate change their sign here, and only here.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

from firmware_bridge.drivers.driver import Feedback
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.mavlink import Message, dialect
from firmware_bridge.teleop.station import AnyStation, Twist, Value
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, to_seconds

UNKNOWN_U16: Final = 0xFFFF
UNKNOWN: Final = -1
NAN: Final = math.nan
_DISTANCES: Final = 16
_FLOATS: Final = 58
_CELLS: Final = 10
_LARGEST_I16: Final = 0x7FFF
_TEMPERATURE_UNKNOWN: Final = 0x7FFF
_OVERHEAD: Final = 12
"""Of a frame of MAVLink 2 without a signature."""
_ARRAY_HEADER: Final = 20
_BITS_A_BYTE: Final = 10
"""On a serial line: a radio's bandwidth is told as the line's rate."""
_SHARE: Final = 0.5
"""Of the bandwidth, for telemetry: half of it is left to commands, answers, lists and the other direction."""
_COVARIANCE_UNKNOWN: Final = (NAN,) + (0.0,) * 20


@dataclass(frozen=True, slots=True, kw_only=True)
class TelemetryContext:
    """Everything that a message may tell."""

    robot: AnyRobot
    station: AnyStation
    rolling: tuple[str, ...]
    """The axes from whose positions the pose is carried on."""
    snapshot: Snapshot[Any, Any]
    twist: Twist
    base_mode: int
    custom_mode: int
    system_status: int
    healthy: bool
    """Nothing but the operator stands between the robot and motion: no emergency stop, no fault."""
    corrupt: int
    resets: int
    """How often the odometry was set to zero."""
    round_trip: Nanoseconds | None
    """To who drives and back; None where he does not answer, or nobody drives."""
    lost: float | None
    """The share of his frames that did not come."""

    @property
    def boot_ms(self) -> int:
        """Time since the start of the run, as most messages carry it."""
        return self.snapshot.facts.now // MILLISECOND & 0xFFFF_FFFF

    @property
    def boot_us(self) -> int:
        """Time since the start of the run, as the wide messages carry it."""
        return self.snapshot.facts.now // 1000

    @property
    def axes(self) -> list[Feedback]:
        """All axes, in the robot file's order."""
        return list(self.snapshot.facts.axes.values())

    @property
    def rolled(self) -> list[Feedback]:
        """The rolling axes of which something is known."""
        axes = self.snapshot.facts.axes
        return [axes[name] for name in self.rolling if name in axes]

    @property
    def battery_v(self) -> float | None:
        """The battery's voltage; None while it is not known, or the robot measures none."""
        battery = self.robot.battery
        reading = None if battery is None else self.snapshot.facts.sensors.get(battery.sensor)
        return None if reading is None else reading.value

    @property
    def low_battery(self) -> bool:
        """Whether the voltage is known and low; what is no number counts as low."""
        battery, volts = self.robot.battery, self.battery_v
        return battery is not None and volts is not None and not volts >= battery.low_v


@dataclass(frozen=True, slots=True)
class Stream:
    """One message that is sent by the clock."""

    number: int
    period: Nanoseconds
    """`NEVER`: to those alone that ask for it."""
    encode: Callable[[TelemetryContext], Iterable[Message]]
    tells: str
    size: int
    """Bytes of it on the link, all messages of one turn."""
    slow: Nanoseconds
    """Its period where the link is narrow."""
    watched: Callable[[TelemetryContext], object] | None = None
    """What makes it due at once, where it changes."""


class Telemetry:
    """What the streams tell at one instant, each made once, however many places it goes to."""

    __slots__ = ("_context", "_made", "_streams")

    def __init__(self, streams: tuple[Stream, ...], context: TelemetryContext) -> None:
        self._streams: Final = streams
        self._context: Final = context
        self._made: Final[dict[int, list[Message]]] = {}

    def changed(self, told: dict[int, object]) -> list[int]:
        """Return the streams that must not wait for their turn; `told` is what they told last."""
        changed: list[int] = []
        for place, stream in enumerate(self._streams):
            if stream.watched is not None:
                seen = stream.watched(self._context)
                if told.setdefault(place, seen) != seen:
                    told[place] = seen
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
    tells: str,
    *,
    slow: Nanoseconds | None = None,
    size: int | None = None,
    times: int = 1,
    watched: Callable[[TelemetryContext], object] | None = None,
) -> Stream:
    """Return a row: its period on a narrow link is five times as long, but not above a second for that.

    `times`: so many messages in one turn. Its size is that of a frame of MAVLink 2 with its whole payload; of
    those that end in zeros it stands in the row.
    """
    each = _OVERHEAD + (dialect.mavlink_map[number].unpacker.size if size is None else size)
    usual = max(period, min(5 * period, SECOND))
    return Stream(number, period, encode, tells, times * each, usual if slow is None else slow, watched)


def streams_of(robot: AnyRobot, station: AnyStation) -> tuple[Stream, ...]:
    """Return what one robot sends, in the order in which it is sent: heartbeat, then the fastest first.

    On a link that is too narrow for all of it, told by the robot file, the rows' slow periods count; on one
    that is too narrow for those, too, all but the heartbeat wait so much longer that it fits.
    """
    rows = _rows(robot, station)
    bandwidth = robot.operator.bandwidth_bit_s
    if bandwidth is None or load(rows) <= (room := bandwidth / _BITS_A_BYTE * _SHARE):
        return _ordered(rows)
    slow = [replace(row, period=row.slow) for row in rows]
    stretch = max(load(slow[1:]) / max(room - load(slow[:1]), 1.0), 1.0)
    stretched = [replace(row, period=min(round(row.slow * stretch), NEVER)) for row in slow[1:]]
    return _ordered([slow[0], *stretched])


def load(rows: Iterable[Stream]) -> float:
    """Return the bytes a second that these rows put on the link."""
    return sum(row.size * SECOND / row.period for row in rows if row.period < NEVER)


def _ordered(rows: list[Stream]) -> tuple[Stream, ...]:
    return (rows[0], *sorted(rows[1:], key=lambda row: row.period))


def _rows(robot: AnyRobot, station: AnyStation) -> list[Stream]:
    """Return the rows at their usual periods, the heartbeat first."""
    switches = ", ".join(switch.telemetry for switch in station.switches if switch.telemetry)
    wheels, currents = len(robot.axes) * 4, len(robot.axes)
    rows: list[Stream] = [
        _stream(
            dialect.MAVLINK_MSG_ID_ODOMETRY,
            SECOND // 20,
            _odometry,
            "pose, speed and yaw rate",
            slow=SECOND // 2,
        ),
        _stream(dialect.MAVLINK_MSG_ID_LOCAL_POSITION_NED, SECOND // 20, _position, "X, Y"),
        _stream(dialect.MAVLINK_MSG_ID_ATTITUDE, SECOND // 20, _attitude, "heading"),
        _stream(dialect.MAVLINK_MSG_ID_WHEEL_DISTANCE, SECOND // 5, _distances, "m, in the order of wheels"),
        *(_stream_of(value) for value in station.values),
        _stream(
            dialect.MAVLINK_MSG_ID_DEBUG_FLOAT_ARRAY,
            SECOND // 10,
            _speeds,
            "wheels: units a second",
            size=_ARRAY_HEADER + wheels,
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT,
            SECOND // 5,
            _currents,
            "I1, I2, ...: A, all axes",
            times=currents,
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT,
            SECOND,
            _link,
            "of who drives: RTT, round trip, s; AGE, of his newest motion command as it came, s; LOSS, share "
            "of his frames",
            times=3,
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_NAMED_VALUE_INT,
            SECOND // 2,
            _switches,
            f"{switches}: 0 or 1",
            times=len(station.switches),
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_SYS_STATUS, SECOND, _system, "voltage, health, corrupt frames, faults"
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_EXTENDED_SYS_STATE,
            SECOND,
            _landed,
            "in the air while it is armed, as an armed rover of PX4 says",
            watched=lambda context: context.snapshot.facts.armed,
        ),
        _stream(dialect.MAVLINK_MSG_ID_BATTERY_STATUS, 2 * SECOND, _battery, "voltage, sum of the currents"),
        _stream(dialect.MAVLINK_MSG_ID_VFR_HUD, SECOND, _hud, "speed, heading in degrees"),
        _stream(
            dialect.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
            SECOND,
            _global,
            "heading and velocity; latitude and longitude 0: not known",
        ),
        _stream(
            dialect.MAVLINK_MSG_ID_CURRENT_MODE,
            2 * SECOND,
            _mode,
            "Manual, Guided or Hold",
            watched=lambda context: context.custom_mode,
        ),
        _stream(dialect.MAVLINK_MSG_ID_AVAILABLE_MODES_MONITOR, 5 * SECOND, _modes, "the modes never change"),
        _stream(dialect.MAVLINK_MSG_ID_GPS_RAW_INT, 5 * SECOND, _no_gps, "that there is none"),
        _stream(dialect.MAVLINK_MSG_ID_HOME_POSITION, NEVER, _home, "where the odometry begins: 0, 0"),
    ]
    lacking = {
        dialect.MAVLINK_MSG_ID_WHEEL_DISTANCE: station.metres_rolled is None,
        dialect.MAVLINK_MSG_ID_NAMED_VALUE_INT: not switches,
        dialect.MAVLINK_MSG_ID_BATTERY_STATUS: robot.battery is None,
    }
    heartbeat = _stream(
        dialect.MAVLINK_MSG_ID_HEARTBEAT,
        SECOND,
        _heartbeat,
        "rover, armed or not, mode, status",
        watched=lambda context: (context.base_mode, context.custom_mode),
    )
    return [heartbeat, *(row for row in rows if not lacking.get(row.number))]


def wrapped(angle_rad: float) -> float:
    """Return the same direction within -pi to pi."""
    return math.remainder(angle_rad, math.tau)


def _stream_of(value: Value[Any, Any]) -> Stream:
    def encode(context: TelemetryContext) -> tuple[Message, ...]:
        number = value.read(context.snapshot)
        return () if number is None else (_named(context.boot_ms, value.name, number),)

    tells = f"{value.name}: {value.tells}"
    return _stream(dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT, value.period, encode, tells)


def _heartbeat(context: TelemetryContext) -> Iterator[Message]:
    kind, nobody = dialect.MAV_TYPE_GROUND_ROVER, dialect.MAV_AUTOPILOT_GENERIC
    yield dialect.MAVLink_heartbeat_message(
        kind, nobody, context.base_mode, context.custom_mode, context.system_status, 3
    )


def _attitude(context: TelemetryContext) -> Iterator[Message]:
    yaw = wrapped(-context.snapshot.pose.heading_rad)
    rate = -context.twist.yaw_rate_rad_s
    yield dialect.MAVLink_attitude_message(context.boot_ms, 0.0, 0.0, yaw, 0.0, 0.0, rate)


def _position(context: TelemetryContext) -> Iterator[Message]:
    pose = context.snapshot.pose
    north, east = _over_ground(context)
    yield dialect.MAVLink_local_position_ned_message(
        context.boot_ms, pose.x_m, -pose.y_m, 0.0, north, east, 0.0
    )


def _odometry(context: TelemetryContext) -> Iterator[Message]:
    pose, twist = context.snapshot.pose, context.twist
    half = wrapped(-pose.heading_rad) / 2.0
    yield dialect.MAVLink_odometry_message(
        time_usec=context.boot_us,
        frame_id=dialect.MAV_FRAME_LOCAL_NED,
        child_frame_id=dialect.MAV_FRAME_BODY_FRD,
        x=pose.x_m,
        y=-pose.y_m,
        z=0.0,
        q=(math.cos(half), 0.0, 0.0, math.sin(half)),
        vx=twist.forward_mps,
        vy=0.0 - twist.left_mps,  # of a zero no negative one
        vz=0.0,
        rollspeed=0.0,
        pitchspeed=0.0,
        yawspeed=-twist.yaw_rate_rad_s,
        pose_covariance=_COVARIANCE_UNKNOWN,
        velocity_covariance=_COVARIANCE_UNKNOWN,
        reset_counter=context.resets & 0xFF,
        estimator_type=dialect.MAV_ESTIMATOR_TYPE_NAIVE,
    )


def _speeds(context: TelemetryContext) -> Iterator[Message]:
    speeds = _padded([axis.velocity for axis in context.rolled], _FLOATS)
    yield dialect.MAVLink_debug_float_array_message(context.boot_us, b"wheels", 1, speeds)


def _distances(context: TelemetryContext) -> Iterator[Message]:
    find = context.station.metres_rolled
    each = NAN if find is None else find(context.robot)
    rolled = [axis.position * each for axis in context.rolled][:_DISTANCES]
    yield dialect.MAVLink_wheel_distance_message(context.boot_us, len(rolled), _padded(rolled, _DISTANCES))


def _currents(context: TelemetryContext) -> Iterator[Message]:
    for place, axis in enumerate(context.axes, 1):
        if axis.current_a is not None:
            yield _named(context.boot_ms, f"I{place}", axis.current_a)


def _link(context: TelemetryContext) -> Iterator[Message]:
    age, trip = context.snapshot.facts.age, context.round_trip
    figures = {
        "RTT": None if trip is None else to_seconds(trip),
        "AGE": None if age is None else to_seconds(age),
        "LOSS": context.lost,
    }
    for name, value in figures.items():
        if value is not None:
            yield _named(context.boot_ms, name, value)


def _switches(context: TelemetryContext) -> Iterator[Message]:
    wish, at = context.snapshot.wish, context.boot_ms
    for switch in context.station.switches:
        if switch.telemetry:
            yield dialect.MAVLink_named_value_int_message(
                at, switch.telemetry.encode("ascii"), int(switch.read(wish))
            )


def _landed(context: TelemetryContext) -> Iterator[Message]:
    """Tell an armed robot as PX4's land detector of rovers does: not landed.

    QGroundControl offers its emergency stop, which brakes, only to what is armed and not landed.
    """
    air, ground = dialect.MAV_LANDED_STATE_IN_AIR, dialect.MAV_LANDED_STATE_ON_GROUND
    state = air if context.snapshot.facts.armed else ground
    yield dialect.MAVLink_extended_sys_state_message(dialect.MAV_VTOL_STATE_UNDEFINED, state)


def _hud(context: TelemetryContext) -> Iterator[Message]:
    speed = math.hypot(context.twist.forward_mps, context.twist.left_mps)
    yield dialect.MAVLink_vfr_hud_message(speed, speed, _compass(context) // 100, 0, 0.0, 0.0)


def _global(context: TelemetryContext) -> Iterator[Message]:
    """Tell the heading where stations look for it; a place of 0, 0 is not known, as ArduPilot sends it."""
    north, east = _over_ground(context)
    yield dialect.MAVLink_global_position_int_message(
        context.boot_ms, 0, 0, 0, 0, _centimetres(north), _centimetres(east), 0, _compass(context)
    )


def _mode(context: TelemetryContext) -> Iterator[Message]:
    number, none = context.custom_mode, dialect.MAV_STANDARD_MODE_NON_STANDARD
    yield dialect.MAVLink_current_mode_message(none, number, number)


def _modes(_: TelemetryContext) -> Iterator[Message]:
    yield dialect.MAVLink_available_modes_monitor_message(0)


def _no_gps(context: TelemetryContext) -> Iterator[Message]:
    unknown = UNKNOWN_U16
    yield dialect.MAVLink_gps_raw_int_message(
        context.boot_us, dialect.GPS_FIX_TYPE_NO_GPS, 0, 0, 0, unknown, unknown, unknown, unknown, 0xFF
    )


def _home(_: TelemetryContext) -> Iterator[Message]:
    north = (1.0, 0.0, 0.0, 0.0)
    yield dialect.MAVLink_home_position_message(0, 0, 0, 0.0, 0.0, 0.0, north, 0.0, 0.0, 0.0)


def _over_ground(context: TelemetryContext) -> tuple[float, float]:
    """Return the velocity north and east, in m/s."""
    heading, twist = context.snapshot.pose.heading_rad, context.twist
    cosine, sine = math.cos(heading), math.sin(heading)
    north = twist.forward_mps * cosine - twist.left_mps * sine
    return north, -twist.forward_mps * sine - twist.left_mps * cosine


def _compass(context: TelemetryContext) -> int:
    """Return the heading clockwise in hundredths of a degree, 0 to 35999; 0 where the odometry began."""
    return round(-math.degrees(context.snapshot.pose.heading_rad) * 100.0) % 36_000


def _centimetres(metres: float) -> int:
    return round(max(min(metres * 100.0, _LARGEST_I16), -_LARGEST_I16))


def _system(context: TelemetryContext) -> Iterator[Message]:
    motors, ready = dialect.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS, dialect.MAV_SYS_STATUS_PREARM_CHECK
    drive = dialect.MAV_SYS_STATUS_SENSOR_PROPULSION
    battery = 0 if context.robot.battery is None else dialect.MAV_SYS_STATUS_SENSOR_BATTERY
    charged = context.battery_v is not None and not context.low_battery
    yield dialect.MAVLink_sys_status_message(
        onboard_control_sensors_present=motors | battery | ready | drive,
        onboard_control_sensors_enabled=battery
        | ready
        | (motors | drive if context.snapshot.facts.armed else 0),
        onboard_control_sensors_health=(motors | ready | drive if context.healthy else 0)
        | (battery if charged else 0),
        load=0,
        voltage_battery=_millivolts(context.battery_v),
        current_battery=_centiamperes(context.axes),
        battery_remaining=UNKNOWN,
        drop_rate_comm=0,
        errors_comm=min(context.corrupt, UNKNOWN_U16),
        errors_count1=sum(1 for axis in context.axes if axis.fault),
        errors_count2=0,
        errors_count3=0,
        errors_count4=0,
    )


def _battery(context: TelemetryContext) -> Iterator[Message]:
    charge = dialect.MAV_BATTERY_CHARGE_STATE_UNDEFINED
    if context.battery_v is not None:
        low, okay = dialect.MAV_BATTERY_CHARGE_STATE_LOW, dialect.MAV_BATTERY_CHARGE_STATE_OK
        charge = low if context.low_battery else okay
    yield dialect.MAVLink_battery_status_message(
        id=0,
        battery_function=dialect.MAV_BATTERY_FUNCTION_ALL,
        type=dialect.MAV_BATTERY_TYPE_UNKNOWN,
        temperature=_TEMPERATURE_UNKNOWN,
        voltages=(_millivolts(context.battery_v),) + (UNKNOWN_U16,) * (_CELLS - 1),
        current_battery=_centiamperes(context.axes),
        current_consumed=UNKNOWN,
        energy_consumed=UNKNOWN,
        battery_remaining=UNKNOWN,
        charge_state=charge,
    )


def _named(boot_ms: int, name: str, value: float) -> Message:
    return dialect.MAVLink_named_value_float_message(boot_ms, name.encode("ascii"), value)


def _padded(values: list[float], length: int) -> list[float]:
    return values[:length] + [0.0] * (length - len(values))


def _millivolts(volts: float | None) -> int:
    if volts is None or math.isnan(volts):
        return UNKNOWN_U16
    return round(max(0.0, min(volts * 1000.0, UNKNOWN_U16 - 1.0)))


def _centiamperes(axes: list[Feedback]) -> int:
    """Return the sum of the motors' currents in 10 mA, at least what the battery gives; -1: unknown."""
    known = [abs(axis.current_a) for axis in axes if axis.current_a is not None]
    if not known or not math.isfinite(sum(known)):
        return UNKNOWN
    return min(round(sum(known) * 1000.0) // 10, _LARGEST_I16)
