"""The operator's information at one instant, message by message; `streams` has the periods.

The robot counts left, up and counter-clockwise positive; MAVLink's NED and FRD frames count right, down and
clockwise: y, yaw and yaw rate change their sign here, and only here.
"""

import math
from collections.abc import Iterator
from typing import Final

from firmware_bridge.drivers.driver import Feedback
from firmware_bridge.mavlink.frames import Message, dialect
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.snapshot import AnySnapshot
from firmware_bridge.teleop.station import AnyStation, Twist
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds
from firmware_bridge.value import valueclass

UNKNOWN_U16: Final = 0xFFFF
UNKNOWN: Final = -1
NAN: Final = math.nan
ROLLING: Final = "wheels"
"""The name of the array of the rolling axes' speeds."""
_DISTANCES: Final = 16
_FLOATS: Final = 58
_CELLS: Final = 10
_LARGEST_I16: Final = 0x7FFF
_TEMPERATURE_UNKNOWN: Final = 0x7FFF
_COVARIANCE_UNKNOWN: Final[tuple[float, ...]] = (NAN,) + (0.0,) * 20


@valueclass(frozen=True, slots=True, kw_only=True)
class TelemetryContext:
    """The context that all messages are made from."""

    robot: AnyRobot
    station: AnyStation
    rolling: tuple[str, ...]
    """The axes from whose positions the pose is carried on."""
    snapshot: AnySnapshot
    twist: Twist
    base_mode: int
    custom_mode: int
    system_status: int
    healthy: bool
    """Nothing but the operator stands between the robot and motion: no emergency stop, no fault."""
    corrupt: int
    resets: int
    """Count of the odometry's resets."""
    round_trip: Nanoseconds | None
    """To the station in control and back; None where it does not answer, or there is none."""
    lost: float | None
    """The share of his frames that did not come."""

    @property
    def boot_ms(self) -> int:
        """Time since the start of the run, as most messages carry it."""
        # 32 bits of milliseconds wrap after 49.7 days.
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
        """True where the voltage is known and low; NaN counts as low."""
        battery, volts = self.robot.battery, self.battery_v
        return battery is not None and volts is not None and not volts >= battery.low_v


def wrapped(angle_rad: float) -> float:
    """Return the same direction within -pi to pi."""
    return math.remainder(angle_rad, math.tau)


def heartbeat(context: TelemetryContext) -> Iterator[Message]:
    """Report what it is, whether it is armed, its way and its status."""
    kind, no_one = dialect.MAV_TYPE_GROUND_ROVER, dialect.MAV_AUTOPILOT_GENERIC
    yield dialect.MAVLink_heartbeat_message(
        kind, no_one, context.base_mode, context.custom_mode, context.system_status, 3
    )


def attitude(context: TelemetryContext) -> Iterator[Message]:
    """Report the heading, and how fast it turns."""
    # MAVLink counts to the right and down (NED, FRD), the robot to the left and up.
    yaw = wrapped(-context.snapshot.pose.heading_rad)
    rate = -context.twist.yaw_rate_rad_s
    yield dialect.MAVLink_attitude_message(context.boot_ms, 0.0, 0.0, yaw, 0.0, 0.0, rate)


def position(context: TelemetryContext) -> Iterator[Message]:
    """Report place and velocity on the map."""
    pose = context.snapshot.pose
    north, east = _over_ground(context)
    yield dialect.MAVLink_local_position_ned_message(
        context.boot_ms, pose.x_m, -pose.y_m, 0.0, north, east, 0.0
    )


def odometry(context: TelemetryContext) -> Iterator[Message]:
    """Report pose, velocity and yaw rate."""
    pose, twist = context.snapshot.pose, context.twist
    # The quaternion of a turn about one axis has half its angle; wrapped first, w is never negative.
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
        # NaN as the first element: the covariance is unknown.
        pose_covariance=_COVARIANCE_UNKNOWN,
        velocity_covariance=_COVARIANCE_UNKNOWN,
        # 8 bits on the wire; only a change of it counts.
        reset_counter=context.resets & 0xFF,
        estimator_type=dialect.MAV_ESTIMATOR_TYPE_NAIVE,
    )


def speeds(context: TelemetryContext) -> Iterator[Message]:
    """Report how fast the rolling axes turn."""
    speeds = _padded([axis.velocity for axis in context.rolled], _FLOATS)
    yield dialect.MAVLink_debug_float_array_message(context.boot_us, ROLLING.encode("ascii"), 1, speeds)


def distances(context: TelemetryContext) -> Iterator[Message]:
    """Report how far the wheels have rolled."""
    find = context.station.meters_rolled
    each = NAN if find is None else find(context.robot)
    rolled = [axis.position * each for axis in context.rolled][:_DISTANCES]
    yield dialect.MAVLink_wheel_distance_message(context.boot_us, len(rolled), _padded(rolled, _DISTANCES))


def currents(context: TelemetryContext) -> Iterator[Message]:
    """Report the currents that are known."""
    for place, axis in enumerate(context.axes, 1):
        if axis.current_a is not None:
            yield named(context.boot_ms, f"I{place}", axis.current_a)


def link(context: TelemetryContext) -> Iterator[Message]:
    """Report the quality of the link to the station in control."""
    age, trip = context.snapshot.facts.age, context.round_trip
    figures = {
        "RTT": None if trip is None else to_seconds(trip),
        "AGE": None if age is None else to_seconds(age),
        "LOSS": context.lost,
    }
    for name, value in figures.items():
        if value is not None:
            yield named(context.boot_ms, name, value)


def switches(context: TelemetryContext) -> Iterator[Message]:
    """Report what is switched on."""
    command, at = context.snapshot.command, context.boot_ms
    for switch in context.station.switches:
        if switch.telemetry:
            yield dialect.MAVLink_named_value_int_message(
                at, switch.telemetry.encode("ascii"), int(switch.read(command))
            )


def landed(context: TelemetryContext) -> Iterator[Message]:
    """Report an armed robot as PX4 reports an armed rover: as not landed.

    QGroundControl offers its emergency stop, which brakes, only for a vehicle that is armed and not landed.
    """
    air, ground = dialect.MAV_LANDED_STATE_IN_AIR, dialect.MAV_LANDED_STATE_ON_GROUND
    state = air if context.snapshot.facts.armed else ground
    yield dialect.MAVLink_extended_sys_state_message(dialect.MAV_VTOL_STATE_UNDEFINED, state)


def hud(context: TelemetryContext) -> Iterator[Message]:
    """Report the speed over ground, and the heading in degrees."""
    speed = math.hypot(context.twist.forward_mps, context.twist.left_mps)
    yield dialect.MAVLink_vfr_hud_message(speed, speed, _compass(context) // 100, 0, 0.0, 0.0)


def global_position(context: TelemetryContext) -> Iterator[Message]:
    """Report the heading where stations look for it; a place of 0, 0 is not known, as ArduPilot sends it."""
    north, east = _over_ground(context)
    yield dialect.MAVLink_global_position_int_message(
        context.boot_ms, 0, 0, 0, 0, _centimeters(north), _centimeters(east), 0, _compass(context)
    )


def current_mode(context: TelemetryContext) -> Iterator[Message]:
    """Report the way in which the robot is driven."""
    number, none = context.custom_mode, dialect.MAV_STANDARD_MODE_NON_STANDARD
    yield dialect.MAVLink_current_mode_message(none, number, number)


def modes_monitor(_: TelemetryContext) -> Iterator[Message]:
    """Report that the list of modes is the same as ever."""
    yield dialect.MAVLink_available_modes_monitor_message(0)


def no_gps(context: TelemetryContext) -> Iterator[Message]:
    """Report that nothing receives satellites."""
    unknown = UNKNOWN_U16
    yield dialect.MAVLink_gps_raw_int_message(
        context.boot_us, dialect.GPS_FIX_TYPE_NO_GPS, 0, 0, 0, unknown, unknown, unknown, unknown, 0xFF
    )


def home(_: TelemetryContext) -> Iterator[Message]:
    """Report where the odometry began: its origin."""
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
    # The remainder after rounding: 359.999 degrees give 0 and not 36000.
    return round(-math.degrees(context.snapshot.pose.heading_rad) * 100.0) % 36_000


def _centimeters(metres: float) -> int:
    return round(max(min(metres * 100.0, _LARGEST_I16), -_LARGEST_I16))


def system(context: TelemetryContext) -> Iterator[Message]:
    """Report what is there, what is healthy, and what has gone wrong on the link."""
    motors, ready = dialect.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS, dialect.MAV_SYS_STATUS_PREARM_CHECK
    drive = dialect.MAV_SYS_STATUS_SENSOR_PROPULSION
    battery = 0 if context.robot.battery is None else dialect.MAV_SYS_STATUS_SENSOR_BATTERY
    charged = context.battery_v is not None and not context.low_battery
    yield dialect.MAVLink_sys_status_message(
        onboard_control_sensors_present=motors | battery | ready | drive,
        onboard_control_sensors_enabled=battery
        | ready
        | (motors | drive if context.snapshot.facts.armed else 0),
        # Of a fence that is not there none is breached: MAVProxy would say so.
        onboard_control_sensors_health=(motors | ready | drive if context.healthy else 0)
        | (battery if charged else 0)
        | dialect.MAV_SYS_STATUS_GEOFENCE,
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


def battery(context: TelemetryContext) -> Iterator[Message]:
    """Report voltage and current."""
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


def named(boot_ms: int, name: str, value: float) -> Message:
    """Return a value with its name, at most ten letters."""
    return dialect.MAVLink_named_value_float_message(boot_ms, name.encode("ascii"), value)


def _padded(values: list[float], length: int) -> list[float]:
    return values[:length] + [0.0] * (length - len(values))


def _millivolts(volts: float | None) -> int:
    if volts is None or math.isnan(volts):
        return UNKNOWN_U16
    # One below the largest: that one means unknown.
    return round(max(0.0, min(volts * 1000.0, UNKNOWN_U16 - 1.0)))


def _centiamperes(axes: list[Feedback]) -> int:
    """Return the sum of the motors' currents in 10 mA, at least what the battery gives; -1: unknown."""
    known = [abs(axis.current_a) for axis in axes if axis.current_a is not None]
    if not known or not math.isfinite(sum(known)):
        return UNKNOWN
    return min(round(sum(known) * 1000.0) // 10, _LARGEST_I16)
