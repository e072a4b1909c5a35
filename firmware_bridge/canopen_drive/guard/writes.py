"""The objects of a drive that may be written over SDO, with their bounds; never a set-point.

The Controlword is in the list with values that only remove power or motion: an earlier run may have left the
drive with power on, and in pre-operational no set-point frame reaches it.

Sources: CiA 301 and CiA 402 for objects and types; robot file for values.
"""

from collections.abc import Iterator
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Mode
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.guard.bounds import ends, highest_speed
from firmware_bridge.canopen_drive.guard.product import GuardedProduct
from firmware_bridge.canopen_drive.guard.values import Values, Writes, exactly, within
from firmware_bridge.canopen_drive.guard.words import ENABLE, HALT, START_HOMING, STOP_WORDS
from firmware_bridge.canopen_drive.guard.zeroing import OWN_MODE, WRITTEN
from firmware_bridge.canopen_drive.settings import DriveAxis, DriveLink
from firmware_bridge.robot import Axis, CommandForm

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


def writes(axis: Axis, product: GuardedProduct, watch: int, heartbeat_ms: int) -> Writes:
    """Return the objects of one drive that may be written."""
    return dict(
        (
            *_process_data(axis),
            *_supervision(watch, heartbeat_ms),
            *_range(axis, product),
            *_motion(axis, product),
            *product.writes.items(),
            *_zero(axis, product),
        )
    )


def watch_of(link: DriveLink, watched: int) -> int:
    """Return the heartbeat consumer entry with which a drive watches a node (0x1016)."""
    # 0x1016 (CiA 301): the node in bits 16 to 23, the time in ms in bits 0 to 15.
    return watched << 16 | link.bridge_silent_ms


def _process_data(axis: Axis) -> Iterator[tuple[Address, Values]]:
    received: dict[int, tuple[int, ...]] = {
        _SET_POINT_PDO[axis.command]: (_CONTROLWORD_MAPPED, _MAPPED[axis.command])
    }
    if DriveAxis.of(axis).profile.quick_stop_least_rpm_s is not None:
        received[BRAKING_PDO] = (_BRAKING_MAPPED,)
    for number in _PDOS:
        communication, mapping = (first + number for first in _RECEIVE)
        identifier = cia301.RECEIVE_PDO[number] + DriveAxis.of(axis).node
        # CiA 301: a mapping may be changed only while bit 31 of the PDO's COB-ID marks it as invalid.
        off = cia301.COB_ID_INVALID | identifier
        mapped = received.get(number, ())
        # The unused receive PDOs can only be switched off: set-points reach a drive by one identifier.
        yield Address(communication, 1), exactly(U32, *((off, identifier) if mapped else (off,)))
        if mapped:
            yield Address(communication, 2), exactly(U8, *TRANSMISSIONS)
            yield Address(mapping, 0), exactly(U8, 0, len(mapped))
            for entry, value in enumerate(mapped, 1):
                yield Address(mapping, entry), exactly(U32, value)
    for number in _PDOS:
        communication, mapping = (first + number for first in _TRANSMIT)
        identifier = cia301.COB_ID_NO_REMOTE | cia301.TRANSMIT_PDO[number] + DriveAxis.of(axis).node
        yield Address(communication, 1), exactly(U32, cia301.COB_ID_INVALID | identifier, identifier)
        yield Address(communication, 2), exactly(U8, *TRANSMISSIONS)
        yield Address(communication, 3), within(U16, U16.lowest, U16.highest)
        yield Address(mapping, 0), within(U8, 0, _MAX_ENTRIES)
        for entry in range(1, _MAX_ENTRIES + 1):
            # Another mapping of these entries would blind the guard, which reads them itself.
            read = _READ.get((number, entry))
            anything = within(U32, U32.lowest, U32.highest)
            yield Address(mapping, entry), anything if read is None else exactly(U32, read)


def _supervision(watch: int, heartbeat_ms: int) -> Iterator[tuple[Address, Values]]:
    yield od.PRODUCER_HEARTBEAT, exactly(U16, heartbeat_ms)
    # 0 ends the watch; the guard lets it through for a drive without power only.
    yield od.CONSUMER_HEARTBEAT_1, exactly(U32, watch, 0)
    yield od.ABORT_CONNECTION_OPTION, exactly(I16, QUICK_STOP_ON_LOST_CONNECTION)
    yield od.FAULT_REACTION_OPTION, exactly(I16, QUICK_STOP_ON_FAULT)
    yield od.ERROR_HISTORY_COUNT, exactly(U8, 0)
    yield od.CONTROLWORD, exactly(U16, *STOP_WORDS)


def _range(axis: Axis, product: GuardedProduct) -> Iterator[tuple[Address, Values]]:
    profile = DriveAxis.of(axis).profile
    yield od.MAX_FOLLOWING_ERROR, within(U32, 1, profile.max_following_error_qc)
    yield od.MAX_PROFILE_VELOCITY, within(U32, 1, product.units.speed(profile.max_velocity_rpm))
    if axis.travel is None:
        return
    (low, high), margin = ends(axis, product.units), profile.max_following_error_qc
    for address in (od.MIN_POSITION_LIMIT, od.MAX_POSITION_LIMIT):
        yield address, within(I32, low - margin, high + margin)


def _motion(axis: Axis, product: GuardedProduct) -> Iterator[tuple[Address, Values]]:
    profile, units = DriveAxis.of(axis).profile, product.units
    zeroing = () if axis.travel is None else (Mode.HOMING,)
    yield od.MODE, exactly(I8, OWN_MODE[axis.command], *zeroing)
    yield od.MOTION_PROFILE_TYPE, exactly(I16, 0)
    by_position = axis.command is CommandForm.POSITION
    top = highest_speed(axis, units) if by_position else units.speed(profile.max_velocity_rpm)
    yield od.PROFILE_VELOCITY, within(U32, 1, top)
    yield od.PROFILE_ACCELERATION, within(U32, 1, units.speed(profile.acceleration_rpm_s))
    # Exactly: a weaker one would brake too late, a stronger one beyond the limit. The quick stop may be
    # weaker where the robot file allows it, down to the inner wheel's in the tightest turn.
    yield od.PROFILE_DECELERATION, exactly(U32, units.speed(profile.deceleration_rpm_s))
    most = profile.quick_stop_rpm_s
    least = profile.quick_stop_least_rpm_s or most
    yield od.QUICK_STOP_DECELERATION, within(U32, units.speed(least), units.speed(most))


def _zero(axis: Axis, product: GuardedProduct) -> Iterator[tuple[Address, Values]]:
    """Yield the writes that reference or home a drive's axis; `zeroing` rules their time and order."""
    if axis.travel is None:
        return
    places = sorted(product.place_sign * end for end in ends(axis, product.units))
    yield product.places, within(I32, *places)
    homing, kinds = product.homing, {**WRITTEN, **product.kinds}
    yield od.HOMING_METHOD, exactly(I8, product.in_place, *homing.get(od.HOMING_METHOD, ()))
    for address in homing.keys() - {od.HOMING_METHOD, product.places}:
        yield address, Values(kinds[address], homing[address])
    # Replaces the entry of the supervision: only an axis with travel may be enabled by SDO, to be referenced.
    yield od.CONTROLWORD, exactly(U16, *STOP_WORDS, ENABLE, HALT, START_HOMING)
