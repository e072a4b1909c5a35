"""What the operator is told and how often: one row for each message.

The robot counts left, up and counter-clockwise positive; MAVLink's NED and FRD frames count right, down and
clockwise: y, yaw and yaw rate change their sign here, and only here.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.robot import Axis, Robot, Role
from firmware_bridge.safety.snapshot import DriveSnapshot, Snapshot
from firmware_bridge.teleop.mavlink import Message, dialect
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

UNKNOWN_U16: Final = 0xFFFF
UNKNOWN: Final = -1
NAN: Final = math.nan
_WHEELS: Final = (Role.LEFT_WHEEL, Role.RIGHT_WHEEL)
_DISTANCES: Final = 16
_FLOATS: Final = 58
_CELLS: Final = 10
_TEMPERATURE_UNKNOWN: Final = 0x7FFF
_COVARIANCE_UNKNOWN: Final = (NAN,) + (0.0,) * 20


@dataclass(frozen=True, slots=True)
class Scene:
    """Everything that a message may tell."""

    robot: Robot
    snapshot: Snapshot
    base_mode: int
    system_status: int
    healthy: bool
    """Nothing but the operator stands between the robot and motion: no emergency stop, no drive fault."""
    corrupt: int
    resets: int
    """How often the odometry was set to zero."""

    @property
    def boot_ms(self) -> int:
        """Time since the start of the run, as most messages carry it."""
        return self.snapshot.now // MILLISECOND & 0xFFFF_FFFF

    @property
    def boot_us(self) -> int:
        """Time since the start of the run, as the wide messages carry it."""
        return self.snapshot.now // 1000


Encoder: TypeAlias = Callable[[Scene], tuple[Message, ...]]


def _heartbeat(scene: Scene) -> tuple[Message, ...]:
    kind, nobody = dialect.MAV_TYPE_GROUND_ROVER, dialect.MAV_AUTOPILOT_GENERIC
    return (dialect.MAVLink_heartbeat_message(kind, nobody, scene.base_mode, 0, scene.system_status, 3),)


def _attitude(scene: Scene) -> tuple[Message, ...]:
    yaw = wrapped(-scene.snapshot.pose.heading_rad)
    rate = -scene.snapshot.yaw_rate_rad_s
    return (dialect.MAVLink_attitude_message(scene.boot_ms, 0.0, 0.0, yaw, 0.0, 0.0, rate),)


def _position(scene: Scene) -> tuple[Message, ...]:
    pose, speed = scene.snapshot.pose, scene.snapshot.speed_mps
    north = speed * math.cos(pose.heading_rad)
    east = -speed * math.sin(pose.heading_rad)
    return (
        dialect.MAVLink_local_position_ned_message(scene.boot_ms, pose.x_m, -pose.y_m, 0.0, north, east, 0.0),
    )


def _odometry(scene: Scene) -> tuple[Message, ...]:
    snapshot = scene.snapshot
    pose = snapshot.pose
    half = wrapped(-pose.heading_rad) / 2.0
    return (
        dialect.MAVLink_odometry_message(
            time_usec=scene.boot_us,
            frame_id=dialect.MAV_FRAME_LOCAL_NED,
            child_frame_id=dialect.MAV_FRAME_BODY_FRD,
            x=pose.x_m,
            y=-pose.y_m,
            z=0.0,
            q=(math.cos(half), 0.0, 0.0, math.sin(half)),
            vx=snapshot.speed_mps,
            vy=0.0,
            vz=0.0,
            rollspeed=0.0,
            pitchspeed=0.0,
            yawspeed=-snapshot.yaw_rate_rad_s,
            pose_covariance=_COVARIANCE_UNKNOWN,
            velocity_covariance=_COVARIANCE_UNKNOWN,
            reset_counter=scene.resets & 0xFF,
            estimator_type=dialect.MAV_ESTIMATOR_TYPE_NAIVE,
        ),
    )


def _steer(scene: Scene) -> tuple[Message, ...]:
    angle = scene.snapshot.steer_rad
    return () if angle is None else (_named(scene, "STEER", math.degrees(angle)),)


def _lift(scene: Scene) -> tuple[Message, ...]:
    height = scene.snapshot.lift_m
    return () if height is None else (_named(scene, "ZPOS", height),)


def _wheels(scene: Scene) -> tuple[Message, ...]:
    speeds = [drive.speed_rad_s for _, drive in _rolling(scene)]
    padded = speeds + [0.0] * (_FLOATS - len(speeds))
    return (dialect.MAVLink_debug_float_array_message(scene.boot_us, b"wheels", 1, padded),)


def _distances(scene: Scene) -> tuple[Message, ...]:
    radius = scene.robot.base.wheel_radius_m
    rolled = [drive.position_qc / axis.quadcounts_per_radian * radius for axis, drive in _rolling(scene)]
    padded = rolled + [0.0] * (_DISTANCES - len(rolled))
    return (dialect.MAVLink_wheel_distance_message(scene.boot_us, len(rolled), padded),)


def _currents(scene: Scene) -> tuple[Message, ...]:
    drives = scene.snapshot.drives
    return tuple(_named(scene, f"I{n}", drive.current_ma / 1000.0) for n, drive in enumerate(drives, 1))


def _switches(scene: Scene) -> tuple[Message, ...]:
    intent, at = scene.snapshot.intent, scene.boot_ms
    return (
        dialect.MAVLink_named_value_int_message(at, b"DETECT", int(intent.detector)),
        dialect.MAVLink_named_value_int_message(at, b"LAMP", int(intent.headlamp)),
    )


def _landed(_: Scene) -> tuple[Message, ...]:
    vtol, ground = dialect.MAV_VTOL_STATE_UNDEFINED, dialect.MAV_LANDED_STATE_ON_GROUND
    return (dialect.MAVLink_extended_sys_state_message(vtol, ground),)


def _system(scene: Scene) -> tuple[Message, ...]:
    snapshot = scene.snapshot
    motors, battery = dialect.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS, dialect.MAV_SYS_STATUS_SENSOR_BATTERY
    ready, drive = dialect.MAV_SYS_STATUS_PREARM_CHECK, dialect.MAV_SYS_STATUS_SENSOR_PROPULSION
    charged = snapshot.battery_v is not None and snapshot.battery_v >= scene.robot.battery.low_v
    return (
        dialect.MAVLink_sys_status_message(
            onboard_control_sensors_present=motors | battery | ready | drive,
            onboard_control_sensors_enabled=battery | ready | (motors | drive if snapshot.armed else 0),
            onboard_control_sensors_health=(motors | ready | drive if scene.healthy else 0)
            | (battery if charged else 0),
            load=0,
            voltage_battery=_millivolts(snapshot),
            current_battery=_centiamperes(snapshot),
            battery_remaining=UNKNOWN,
            drop_rate_comm=0,
            errors_comm=min(scene.corrupt, UNKNOWN_U16),
            errors_count1=sum(1 for one in snapshot.drives if one.fault),
            errors_count2=0,
            errors_count3=0,
            errors_count4=0,
        ),
    )


def _battery(scene: Scene) -> tuple[Message, ...]:
    volts = scene.snapshot.battery_v
    charge = dialect.MAV_BATTERY_CHARGE_STATE_UNDEFINED
    if volts is not None:
        low = volts < scene.robot.battery.low_v
        charge = dialect.MAV_BATTERY_CHARGE_STATE_LOW if low else dialect.MAV_BATTERY_CHARGE_STATE_OK
    return (
        dialect.MAVLink_battery_status_message(
            id=0,
            battery_function=dialect.MAV_BATTERY_FUNCTION_ALL,
            type=dialect.MAV_BATTERY_TYPE_UNKNOWN,
            temperature=_TEMPERATURE_UNKNOWN,
            voltages=(_millivolts(scene.snapshot),) + (UNKNOWN_U16,) * (_CELLS - 1),
            current_battery=_centiamperes(scene.snapshot),
            current_consumed=UNKNOWN,
            energy_consumed=UNKNOWN,
            battery_remaining=UNKNOWN,
            charge_state=charge,
        ),
    )


@dataclass(frozen=True, slots=True)
class Stream:
    """One message that is sent by the clock."""

    number: int
    period: Nanoseconds
    encode: Encoder
    tells: str


STREAMS: Final = (
    Stream(dialect.MAVLINK_MSG_ID_HEARTBEAT, SECOND, _heartbeat, "rover, armed or not, status"),
    Stream(dialect.MAVLINK_MSG_ID_ODOMETRY, SECOND // 20, _odometry, "pose, speed and yaw rate"),
    Stream(dialect.MAVLINK_MSG_ID_LOCAL_POSITION_NED, SECOND // 20, _position, "X, Y"),
    Stream(dialect.MAVLINK_MSG_ID_ATTITUDE, SECOND // 20, _attitude, "heading"),
    Stream(
        dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT,
        SECOND // 10,
        _steer,
        "STEER: inner wheel, deg, left positive",
    ),
    Stream(dialect.MAVLINK_MSG_ID_DEBUG_FLOAT_ARRAY, SECOND // 10, _wheels, "wheels: rad/s, left and right"),
    Stream(dialect.MAVLINK_MSG_ID_WHEEL_DISTANCE, SECOND // 5, _distances, "m, left and right"),
    Stream(dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT, SECOND // 5, _lift, "ZPOS: m above collapsed"),
    Stream(
        dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT,
        SECOND // 5,
        _currents,
        "I1, I2, ...: A, in the robot file's order",
    ),
    Stream(dialect.MAVLINK_MSG_ID_NAMED_VALUE_INT, SECOND // 2, _switches, "DETECT, LAMP: 0 or 1"),
    Stream(
        dialect.MAVLINK_MSG_ID_SYS_STATUS, SECOND, _system, "battery, health, corrupt frames, faulted drives"
    ),
    Stream(dialect.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, SECOND, _landed, "on the ground"),
    Stream(
        dialect.MAVLINK_MSG_ID_BATTERY_STATUS, 2 * SECOND, _battery, "voltage, sum of the motors' currents"
    ),
)


def tell(number: int, scene: Scene) -> tuple[Message, ...]:
    """Return one message of every stream with this number, for a station that asks for it."""
    return tuple(message for stream in STREAMS if stream.number == number for message in stream.encode(scene))


def wrapped(angle_rad: float) -> float:
    """Return the same direction within -pi to pi."""
    return math.remainder(angle_rad, math.tau)


def _rolling(scene: Scene) -> list[tuple[Axis, DriveSnapshot]]:
    drives: Mapping[str, DriveSnapshot] = {drive.axis: drive for drive in scene.snapshot.drives}
    return [
        (axis, drives[axis.name]) for axis in scene.robot.axes if axis.role in _WHEELS and axis.name in drives
    ]


def _named(scene: Scene, name: str, value: float) -> Message:
    return dialect.MAVLink_named_value_float_message(scene.boot_ms, name.encode("ascii"), value)


def _millivolts(snapshot: Snapshot) -> int:
    volts = snapshot.battery_v
    return UNKNOWN_U16 if volts is None else max(0, min(round(volts * 1000.0), UNKNOWN_U16 - 1))


def _centiamperes(snapshot: Snapshot) -> int:
    """Return the sum of the motors' currents, an upper bound of what the battery gives; 10 mA."""
    return min(sum(abs(drive.current_ma) for drive in snapshot.drives) // 10, 0x7FFF)
