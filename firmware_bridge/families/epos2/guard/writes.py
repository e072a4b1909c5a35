"""The objects of a drive that may be written over SDO, with their bounds; never a set-point.

The Controlword is in the list with values that only remove power or motion: an earlier run may have left the
drive with power on, and in pre-operational no set-point frame reaches it.

Sources: EPOS2 EDS for objects and types; robot file for values.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.families.epos2.guard.bounds import ends_qc, highest_rpm
from firmware_bridge.families.epos2.guard.words import ENABLE, HALT, START_HOMING, STOP_WORDS
from firmware_bridge.families.epos2.guard.zeroing import ACTUAL_POSITION, OWN_MODE, WRITTEN, by_file
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2DigitalOutput, Epos2Link, nodes_on
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire import functions
from firmware_bridge.families.epos2.wire.functions import OutputFunction
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.robot import AnyRobot, Axis, CommandForm, Output

I8: Final = DataType.INTEGER8
I16: Final = DataType.INTEGER16
I32: Final = DataType.INTEGER32
U8: Final = DataType.UNSIGNED8
U16: Final = DataType.UNSIGNED16
U32: Final = DataType.UNSIGNED32

QUICK_STOP_ON_LOST_CONNECTION: Final = 3
QUICK_STOP_ON_FAULT: Final = 2
TRANSMISSIONS: Final = (1, 255)
"""At each SYNC, on change: what the EPOS2 supports and the bridge uses."""
_MAPPED: Final = {CommandForm.SPEED: 0x60FF_0020, CommandForm.POSITION: 0x607A_0020}
_CONTROLWORD_MAPPED: Final = 0x6040_0010
_SET_POINT_PDO: Final = {CommandForm.SPEED: 3, CommandForm.POSITION: 2}
BRAKING_PDO: Final = 0
_BRAKING_MAPPED: Final = 0x6085_0020
STATUS_PDO, SAMPLE_PDO = 0, 1
_READ: Final = {(STATUS_PDO, 1): 0x6041_0010, (SAMPLE_PDO, 1): 0x6041_0010, (SAMPLE_PDO, 2): 0x6064_0020}
"""Entries of transmit PDOs that the guard itself reads: statusword and position."""
_RECEIVE: Final = (0x1400, 0x1600)
_TRANSMIT: Final = (0x1800, 0x1A00)
_PDOS: Final = range(4)
_MAX_ENTRIES: Final = 8


@dataclass(frozen=True, slots=True)
class Bits:
    """Any of these bits, and no other."""

    mask: int

    def __contains__(self, value: int) -> bool:
        # A bit outside the mask would switch an output that the robot file does not name.
        return not value & ~self.mask


@dataclass(frozen=True, slots=True)
class Values:
    """Permitted values of one object: a range, a few values, or some bits."""

    type: DataType
    allowed: range | tuple[int, ...] | Bits

    def refuses(self, address: Address, raw: bytes) -> str | None:
        """Return why these bytes may not be written, or None."""
        if len(raw) != self.type.size:
            return f"{address} written with {len(raw)} bytes, it has {self.type.size}"
        value = self.type.decode(raw)
        return None if value in self.allowed else f"{address} set to {value}, allowed is {self._shown()}"

    def _shown(self) -> str:
        if isinstance(self.allowed, range):
            return f"{self.allowed.start} to {self.allowed.stop - 1}"
        if isinstance(self.allowed, Bits):
            return f"the bits 0x{self.allowed.mask:04X}"
        return " or ".join(str(value) for value in self.allowed)


Writes: TypeAlias = Mapping[Address, Values]


def output_function(output: Output) -> OutputFunction:
    """Return the function that the output's pin must have: general purpose A for pin 1 to D for pin 4.

    That is how the drive leaves the factory (EPOS2 EDS).
    """
    return OutputFunction(OutputFunction.GENERAL_A - (Epos2DigitalOutput.of(output).output - 1))


def writes_on_can(axis: Axis, robot: AnyRobot) -> Writes:
    """Return the objects of one drive that the bridge reaches over CAN."""
    link = Epos2Link.of_link(robot, axis.link)
    return _writes(axis, robot, _watch(link, link.bridge_node), link.drive_heartbeat_ms)


def writes_over_serial(axis: Axis, robot: AnyRobot) -> Writes:
    """Return the objects of one drive that the bridge reaches by serial commands, set-points left out.

    The drive has no heartbeat there, and watches whom the robot file makes it watch.
    """
    link = Epos2Link.of_link(robot, axis.link)
    watched = link.watched_by(Epos2Axis.of(axis).node, nodes_on(robot, axis.link))
    return _writes(axis, robot, _watch(link, watched), 0)


def _writes(axis: Axis, robot: AnyRobot, watch: int, heartbeat_ms: int) -> Writes:
    outputs = [
        row for row in robot.outputs if row.link == axis.link and Epos2DigitalOutput.of(row).axis == axis.name
    ]
    return dict(
        (
            *_process_data(axis),
            *_supervision(watch, heartbeat_ms),
            *_protection(axis),
            *_range(axis),
            *_motion(axis),
            *_gains(axis),
            *_outputs(outputs),
            *_zero(axis),
        )
    )


def _watch(link: Epos2Link, watched: int) -> int:
    """Return the heartbeat consumer entry with which a drive watches a node (0x1016)."""
    # 0x1016 (CiA 301): the node in bits 16 to 23, the time in ms in bits 0 to 15.
    return watched << 16 | link.bridge_silent_ms


def _exactly(kind: DataType, *values: int) -> Values:
    return Values(kind, values)


def _within(kind: DataType, low: int, high: int) -> Values:
    return Values(kind, range(low, high + 1))


def _process_data(axis: Axis) -> Iterator[tuple[Address, Values]]:
    received: dict[int, tuple[int, ...]] = {
        _SET_POINT_PDO[axis.command]: (_CONTROLWORD_MAPPED, _MAPPED[axis.command])
    }
    if Epos2Axis.of(axis).profile.quick_stop_least_rpm_s is not None:
        received[BRAKING_PDO] = (_BRAKING_MAPPED,)
    for number in _PDOS:
        communication, mapping = (first + number for first in _RECEIVE)
        identifier = cia301.RECEIVE_PDO[number] + Epos2Axis.of(axis).node
        # CiA 301: a mapping may be changed only while bit 31 of the PDO's COB-ID marks it as invalid.
        off = cia301.COB_ID_INVALID | identifier
        mapped = received.get(number, ())
        # The unused receive PDOs can only be switched off: set-points reach a drive by one identifier.
        yield Address(communication, 1), _exactly(U32, *((off, identifier) if mapped else (off,)))
        if mapped:
            yield Address(communication, 2), _exactly(U8, *TRANSMISSIONS)
            yield Address(mapping, 0), _exactly(U8, 0, len(mapped))
            for entry, value in enumerate(mapped, 1):
                yield Address(mapping, entry), _exactly(U32, value)
    for number in _PDOS:
        communication, mapping = (first + number for first in _TRANSMIT)
        identifier = cia301.COB_ID_NO_REMOTE | cia301.TRANSMIT_PDO[number] + Epos2Axis.of(axis).node
        yield Address(communication, 1), _exactly(U32, cia301.COB_ID_INVALID | identifier, identifier)
        yield Address(communication, 2), _exactly(U8, *TRANSMISSIONS)
        yield Address(communication, 3), _within(U16, U16.lowest, U16.highest)
        yield Address(mapping, 0), _within(U8, 0, _MAX_ENTRIES)
        for entry in range(1, _MAX_ENTRIES + 1):
            # Another mapping of these entries would blind the guard, which reads them itself.
            read = _READ.get((number, entry))
            anything = _within(U32, U32.lowest, U32.highest)
            yield Address(mapping, entry), anything if read is None else _exactly(U32, read)


def _supervision(watch: int, heartbeat_ms: int) -> Iterator[tuple[Address, Values]]:
    yield od.PRODUCER_HEARTBEAT, _exactly(U16, heartbeat_ms)
    # 0 ends the watch; the guard lets it through for a drive without power only.
    yield od.CONSUMER_HEARTBEAT_1, _exactly(U32, watch, 0)
    yield od.ABORT_CONNECTION_OPTION, _exactly(I16, QUICK_STOP_ON_LOST_CONNECTION)
    yield od.FAULT_REACTION_OPTION, _exactly(I16, QUICK_STOP_ON_FAULT)
    yield od.ERROR_HISTORY_COUNT, _exactly(U8, 0)
    yield od.CONTROLWORD, _exactly(U16, *STOP_WORDS)


def _protection(axis: Axis) -> Iterator[tuple[Address, Values]]:
    drive = Epos2Axis.of(axis)
    profile = drive.profile
    yield od.MOTOR_TYPE, _exactly(U16, drive.motor_type)
    if drive.pole_pairs is not None:
        yield at.POLE_PAIRS, _exactly(U8, drive.pole_pairs)
    yield at.ENCODER_PULSES, _exactly(U32, drive.encoder_lines)
    yield at.CONTINUOUS_CURRENT_LIMIT, _within(U16, 0, drive.continuous_current_ma)
    yield at.OUTPUT_CURRENT_LIMIT, _within(U16, 0, drive.peak_current_ma)
    yield at.THERMAL_TIME_CONSTANT, _within(U16, 1, drive.thermal_time_constant_100ms)
    yield at.MAX_MOTOR_SPEED, _within(U32, 1, profile.max_velocity_rpm)
    yield od.MAX_PROFILE_VELOCITY, _within(U32, 1, profile.max_velocity_rpm)
    yield od.MAX_FOLLOWING_ERROR, _within(U32, 1, profile.max_following_error_qc)


def _range(axis: Axis) -> Iterator[tuple[Address, Values]]:
    if axis.travel is None:
        return
    (low, high), margin = ends_qc(axis), Epos2Axis.of(axis).profile.max_following_error_qc
    for address in (od.MIN_POSITION_LIMIT, od.MAX_POSITION_LIMIT):
        yield address, _within(I32, low - margin, high + margin)


def _motion(axis: Axis) -> Iterator[tuple[Address, Values]]:
    profile = Epos2Axis.of(axis).profile
    zeroing = () if axis.travel is None else (Mode.HOMING,)
    yield od.MODE, _exactly(I8, OWN_MODE[axis.command], *zeroing)
    yield od.MOTION_PROFILE_TYPE, _exactly(I16, 0)
    top_rpm = highest_rpm(axis) if axis.command is CommandForm.POSITION else profile.max_velocity_rpm
    yield od.PROFILE_VELOCITY, _within(U32, 1, top_rpm)
    yield od.PROFILE_ACCELERATION, _within(U32, 1, profile.acceleration_rpm_s)
    # Exactly: a weaker one would brake too late, a stronger one beyond the limit. The quick stop may be
    # weaker where the robot file allows it, down to the inner wheel's in the tightest turn.
    yield od.PROFILE_DECELERATION, _exactly(U32, profile.deceleration_rpm_s)
    least = profile.quick_stop_least_rpm_s or profile.quick_stop_rpm_s
    yield od.QUICK_STOP_DECELERATION, _within(U32, least, profile.quick_stop_rpm_s)


def _gains(axis: Axis) -> Iterator[tuple[Address, Values]]:
    gains = Epos2Axis.of(axis).gains
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


def _zero(axis: Axis) -> Iterator[tuple[Address, Values]]:
    """Yield the writes that reference or home a drive's axis; `zeroing` rules their time and order."""
    if axis.travel is None:
        return
    yield at.HOME_POSITION, _within(I32, *ends_qc(axis))
    homing = by_file(axis)
    yield od.HOMING_METHOD, _exactly(I8, ACTUAL_POSITION, *homing.get(od.HOMING_METHOD, ()))
    for address in homing.keys() - {od.HOMING_METHOD, at.HOME_POSITION}:
        yield address, Values(WRITTEN[address], homing[address])
    # Replaces the entry of the supervision: only an axis with travel may be enabled by SDO, to be referenced.
    yield od.CONTROLWORD, _exactly(U16, *STOP_WORDS, ENABLE, HALT, START_HOMING)


def _outputs(outputs: Sequence[Output]) -> Iterator[tuple[Address, Values]]:
    if not outputs:
        return
    bits = 0
    for output in outputs:
        function = output_function(output)
        bits |= function.bit
        yield functions.OUTPUT_PINS[Epos2DigitalOutput.of(output).output - 1], _exactly(U16, function)
    yield functions.OUTPUT_STATE, Values(U16, Bits(bits))
    yield functions.OUTPUT_MASK, Values(U16, Bits(bits))
