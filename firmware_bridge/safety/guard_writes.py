"""Which objects of a drive may be written over SDO, and within which bounds; never a set-point.

The controlword is in the list with words that only take power or motion away: an earlier run may have left
the drive with power on, and in pre-operational no set-point frame reaches it.

Sources: EPOS2 EDS for objects and types; robot file for values.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from firmware_bridge.robot import Axis, Bus, Mode, Robot
from firmware_bridge.wire import canopen
from firmware_bridge.wire.cia402 import Mode as DriveMode
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.rows import DataType

I8: Final = DataType.INTEGER8
I16: Final = DataType.INTEGER16
I32: Final = DataType.INTEGER32
U8: Final = DataType.UNSIGNED8
U16: Final = DataType.UNSIGNED16
U32: Final = DataType.UNSIGNED32

QUICK_STOP_ON_LOST_CONNECTION: Final = 3
QUICK_STOP_ON_FAULT: Final = 2
STOP_WORDS: Final = (0x0000, 0x0002, 0x000B)
"""Disable voltage and two spellings of quick stop."""
TRANSMISSIONS: Final = (1, 255)
"""At each SYNC, on change: what the EPOS2 supports and the bridge uses."""
_MODES: Final = {Mode.VELOCITY: DriveMode.PROFILE_VELOCITY, Mode.POSITION: DriveMode.PROFILE_POSITION}
_MAPPED: Final = {Mode.VELOCITY: 0x60FF_0020, Mode.POSITION: 0x607A_0020}
_CONTROLWORD_MAPPED: Final = 0x6040_0010
_SET_POINT_PDO: Final = {Mode.VELOCITY: 3, Mode.POSITION: 2}
_RECEIVE: Final = (0x1400, 0x1600)
_TRANSMIT: Final = (0x1800, 0x1A00)
_PDOS: Final = range(4)
_MAX_ENTRIES: Final = 8


@dataclass(frozen=True, slots=True)
class Bounds:
    """What one object may be set to: a range, or a few values."""

    type: DataType
    allowed: range | tuple[int, ...]

    def refuses(self, address: Address, raw: bytes) -> str | None:
        """Return why these bytes may not be written, or None."""
        if len(raw) != self.type.size:
            return f"{address} written with {len(raw)} bytes, it has {self.type.size}"
        value = self.type.decode(raw)
        return None if value in self.allowed else f"{address} set to {value}, allowed is {self._shown()}"

    def _shown(self) -> str:
        if isinstance(self.allowed, range):
            return f"{self.allowed.start} to {self.allowed.stop - 1}"
        return " or ".join(str(value) for value in self.allowed)


def watch_entry(bus: Bus, watched: int | None = None) -> int:
    """Return the heartbeat consumer entry with which a drive watches the bridge, or another node (0x1016)."""
    return (bus.bridge_node if watched is None else watched) << 16 | bus.bridge_silent_ms


def writes_over_serial(axis: Axis, robot: Robot, ends: tuple[int, int] | None) -> Mapping[Address, Bounds]:
    """Return the objects of one drive that the bridge reaches by serial commands, set-points left out.

    It has no heartbeat of its own there, and watches whom the robot file makes it watch.
    """
    watch = _exactly(U32, watch_entry(robot.bus, robot.watched_by(axis)), 0)
    others = {at.PRODUCER_HEARTBEAT: _exactly(U16, 0), at.CONSUMER_HEARTBEAT_1: watch}
    return {**writes_for(axis, robot.bus, ends), **others}


def writes_for(axis: Axis, bus: Bus, ends: tuple[int, int] | None) -> Mapping[Address, Bounds]:
    """Return the objects of one drive; `ends` is the mechanical range of a position axis in quadcounts."""
    return dict(
        (
            *_process_data(axis),
            *_supervision(bus),
            *_protection(axis),
            *_range(axis, ends),
            *_motion(axis),
            *_gains(axis),
        )
    )


def _exactly(kind: DataType, *values: int) -> Bounds:
    return Bounds(kind, values)


def _within(kind: DataType, low: int, high: int) -> Bounds:
    return Bounds(kind, range(low, high + 1))


def _process_data(axis: Axis) -> Iterator[tuple[Address, Bounds]]:
    for number in _PDOS:
        communication, mapping = (first + number for first in _RECEIVE)
        identifier = canopen.RECEIVE_PDO[number] + axis.node
        off = canopen.COB_ID_INVALID | identifier
        used = number == _SET_POINT_PDO[axis.mode]
        yield Address(communication, 1), _exactly(U32, *((off, identifier) if used else (off,)))
        if used:
            yield Address(communication, 2), _exactly(U8, *TRANSMISSIONS)
            yield Address(mapping, 0), _exactly(U8, 0, 2)
            yield Address(mapping, 1), _exactly(U32, _CONTROLWORD_MAPPED)
            yield Address(mapping, 2), _exactly(U32, _MAPPED[axis.mode])
    for number in _PDOS:
        communication, mapping = (first + number for first in _TRANSMIT)
        identifier = canopen.COB_ID_NO_REMOTE | canopen.TRANSMIT_PDO[number] + axis.node
        yield Address(communication, 1), _exactly(U32, canopen.COB_ID_INVALID | identifier, identifier)
        yield Address(communication, 2), _exactly(U8, *TRANSMISSIONS)
        yield Address(communication, 3), _within(U16, U16.lowest, U16.highest)
        yield Address(mapping, 0), _within(U8, 0, _MAX_ENTRIES)
        for entry in range(1, _MAX_ENTRIES + 1):
            yield Address(mapping, entry), _within(U32, U32.lowest, U32.highest)


def _supervision(bus: Bus) -> Iterator[tuple[Address, Bounds]]:
    yield at.PRODUCER_HEARTBEAT, _exactly(U16, bus.drive_heartbeat_ms)
    # 0 ends the watch; the guard lets it through for a drive without power only.
    yield at.CONSUMER_HEARTBEAT_1, _exactly(U32, watch_entry(bus), 0)
    yield at.ABORT_CONNECTION_OPTION, _exactly(I16, QUICK_STOP_ON_LOST_CONNECTION)
    yield at.FAULT_REACTION_OPTION, _exactly(I16, QUICK_STOP_ON_FAULT)
    yield at.ERROR_HISTORY_COUNT, _exactly(U8, 0)
    yield at.CONTROLWORD, _exactly(U16, *STOP_WORDS)


def _protection(axis: Axis) -> Iterator[tuple[Address, Bounds]]:
    profile = axis.profile
    yield at.MOTOR_TYPE, _exactly(U16, axis.motor_type)
    yield at.ENCODER_PULSES, _exactly(U32, axis.encoder_lines)
    yield at.CONTINUOUS_CURRENT_LIMIT, _within(U16, 0, axis.continuous_current_ma)
    yield at.OUTPUT_CURRENT_LIMIT, _within(U16, 0, axis.peak_current_ma)
    yield at.THERMAL_TIME_CONSTANT, _within(U16, 1, axis.thermal_time_constant_100ms)
    yield at.MAX_MOTOR_SPEED, _within(U32, 1, profile.max_velocity_rpm)
    yield at.MAX_PROFILE_VELOCITY, _within(U32, 1, profile.max_velocity_rpm)
    yield at.MAX_FOLLOWING_ERROR, _within(U32, 1, profile.max_following_error_qc)


def _range(axis: Axis, ends: tuple[int, int] | None) -> Iterator[tuple[Address, Bounds]]:
    if ends is None:
        return
    margin = axis.profile.max_following_error_qc
    for address in (at.MIN_POSITION_LIMIT, at.MAX_POSITION_LIMIT):
        yield address, _within(I32, ends[0] - margin, ends[1] + margin)


def _motion(axis: Axis) -> Iterator[tuple[Address, Bounds]]:
    profile = axis.profile
    yield at.MODE, _exactly(I8, _MODES[axis.mode])
    yield at.MOTION_PROFILE_TYPE, _exactly(I16, 0)
    yield at.PROFILE_VELOCITY, _within(U32, 1, profile.max_velocity_rpm)
    yield at.PROFILE_ACCELERATION, _within(U32, 1, profile.acceleration_rpm_s)
    # Exactly, both: a weaker one would brake too late, a stronger one beyond the limit.
    yield at.PROFILE_DECELERATION, _exactly(U32, profile.deceleration_rpm_s)
    yield at.QUICK_STOP_DECELERATION, _exactly(U32, profile.quick_stop_rpm_s)


def _gains(axis: Axis) -> Iterator[tuple[Address, Bounds]]:
    gains = axis.gains
    for address, kind, value in (
        (at.CURRENT_P, I16, gains.current_p),
        (at.CURRENT_I, I16, gains.current_i),
        (at.VELOCITY_P, I16, gains.velocity_p),
        (at.VELOCITY_I, I16, gains.velocity_i),
        (at.VELOCITY_FEEDFORWARD, U16, gains.velocity_feedforward),
        (at.VELOCITY_ACCELERATION_FEEDFORWARD, U16, gains.acceleration_feedforward),
        (at.POSITION_P, I16, gains.position_p),
        (at.POSITION_I, I16, gains.position_i),
        (at.POSITION_D, I16, gains.position_d),
        (at.POSITION_VELOCITY_FEEDFORWARD, U16, gains.position_velocity_feedforward),
        (at.POSITION_ACCELERATION_FEEDFORWARD, U16, gains.position_acceleration_feedforward),
    ):
        yield address, _exactly(kind, value)
