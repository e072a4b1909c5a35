"""The output guard of drives on CAN: permitted identifiers, their content and its effect.

An identifier that is not in the list is refused; so is one with a flag (extended, remote).

How fast a set-point may CHANGE is not judged here: a late cycle or a substituted frame makes honest jumps.
The drive's own profile acceleration bounds every jump; this list permits none above the robot file's, and the
bridge reads it back at start-up.

Source: CiA 301 for identifiers and services.
"""

import struct
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Final, Protocol

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.canopen.objects import CONSUMER_HEARTBEAT_1, CONTROLWORD, STATUSWORD
from firmware_bridge.canopen_drive.guard.axis import GuardedAxis
from firmware_bridge.canopen_drive.guard.product import GuardedProduct
from firmware_bridge.canopen_drive.guard.values import Writes
from firmware_bridge.canopen_drive.guard.words import (
    CONTROLWORDS,
    LISTED_NMT,
    GuardedSetPoint,
)
from firmware_bridge.canopen_drive.guard.writes import (
    BRAKING_PDO,
    SAMPLE_PDO,
    STATUS_PDO,
    watch_of,
    writes,
)
from firmware_bridge.canopen_drive.settings import DriveAxis, DriveLink
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis, CommandForm
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.safety.guard.wire_rules import WireRules
from firmware_bridge.units import Nanoseconds

_SET_POINT: Final = struct.Struct("<Hi")
"""Controlword and target, as the bridge maps them."""
_SET_POINT_ID: Final = {
    CommandForm.SPEED: cia301.RECEIVE_PDO[3],
    CommandForm.POSITION: cia301.RECEIVE_PDO[2],
}
_BRAKING: Final = struct.Struct("<I")
_STATUSWORD: Final = struct.Struct("<H")
_SAMPLE: Final = struct.Struct("<Hi")
"""Statusword and position, as the bridge maps them first."""
_SDO_LENGTH: Final = 8
_SPECIFIER: Final = 0xE0
_DOWNLOAD: Final = 0x20
_UPLOADED: Final = 0x40
"""From the server: initiate upload."""
_READING: Final = (0x40, 0x60, 0x80)
"""Initiate upload, upload segment, abort: they change nothing in a drive."""
_EXPEDITED_SIZED: Final = 0x23
_EXPEDITED_BITS: Final = 0x33
_ABORT: Final = 0x80
_GENERAL_ERROR: Final = 0x0800_0000


class Content(Protocol):
    """The permitted content of one identifier."""

    def refuses(self, payload: bytes) -> str | None:
        """Return why these bytes may not leave, or None."""


@dataclass(frozen=True, slots=True)
class Exactly:
    """One of a few payloads."""

    payloads: tuple[bytes, ...]

    def refuses(self, payload: bytes) -> str | None:
        """Compare."""
        return None if payload in self.payloads else f"content '{payload.hex(' ')}' is not listed"


@dataclass(frozen=True, slots=True)
class AxisSetPoint:
    """Controlword and target of one axis."""

    command: CommandForm
    targets: range
    unit: str

    def refuses(self, payload: bytes) -> str | None:
        """Check length, controlword and target."""
        if len(payload) != _SET_POINT.size:
            return f"{len(payload)} bytes where {_SET_POINT.size} are mapped"
        word, target = GuardedSetPoint(*_SET_POINT.unpack(payload))
        if word not in CONTROLWORDS[self.command]:
            return f"controlword 0x{word:04X} is not listed"
        if target not in self.targets:
            bounds = f"{self.targets[0]} to {self.targets[-1]}"
            return f"target {target} {self.unit} is not within {bounds} {self.unit}"
        return None


@dataclass(frozen=True, slots=True)
class Braking:
    """The quick stop deceleration of one axis."""

    least: int
    most: int
    unit: str

    def refuses(self, payload: bytes) -> str | None:
        """Check length and value."""
        if len(payload) != _BRAKING.size:
            return f"{len(payload)} bytes where {_BRAKING.size} are mapped"
        (value,) = _BRAKING.unpack(payload)
        if self.least <= value <= self.most:
            return None
        unit = f"{self.unit}/s"
        return f"quick stop deceleration of {value} {unit} is not within {self.least} to {self.most} {unit}"


@dataclass(frozen=True, slots=True)
class SdoRequest:
    """Requests to one drive: uploads of anything, expedited downloads of what is listed."""

    writes: Writes

    def refuses(self, payload: bytes) -> str | None:
        """Check length, service, object, size and value."""
        if len(payload) != _SDO_LENGTH:
            return f"an SDO request of {len(payload)} bytes"
        if payload[0] & _SPECIFIER in _READING:
            return None
        # Segments carry no address, so a segmented value could not be judged: only expedited, with a size.
        if payload[0] & _EXPEDITED_BITS != _EXPEDITED_SIZED or payload[0] & _SPECIFIER != _DOWNLOAD:
            return f"SDO command 0x{payload[0]:02X} is not listed"
        address = Address(int.from_bytes(payload[1:3], "little"), payload[3])
        values = self.writes.get(address)
        if values is None:
            return f"{address} is not an object that may be written"
        # Bits 2 and 3: the number of data bytes without content (CiA 301, initiate download).
        unused = payload[0] >> 2 & 0b11
        return values.refuses(address, payload[4 : _SDO_LENGTH - unused])


class DriveCanRules(WireRules):
    """Frames that leave when they are handed over, and answers that go to their receivers."""

    axes: tuple[GuardedAxis, ...]

    def __init__(
        self, robot: AnyRobot, link: str, product: Callable[[Axis, AnyRobot], GuardedProduct]
    ) -> None:
        """Take the robot, the name of the link, and what returns the product of each axis."""
        self.link = link
        products = {axis.name: product(axis, robot) for axis in robot.axes_on(link)}
        self.axes = tuple(GuardedAxis(axis, robot, products[axis.name]) for axis in robot.axes_on(link))
        self.listed: Final = _listed(robot, link, self.axes, products)
        """The permitted content, by identifier."""
        self._by_node = {axis.node: axis for axis in self.axes}
        self._by_set_point = {_set_point_id(axis): axis for axis in self.axes}
        self._by_request = {cia301.SDO_REQUEST + axis.node: axis for axis in self.axes}
        self._readers = {
            first + axis.node: (read, axis)
            for axis in self.axes
            for first, read in (
                (cia301.TRANSMIT_PDO[STATUS_PDO], _read_status),
                (cia301.TRANSMIT_PDO[SAMPLE_PDO], _read_sample),
                (cia301.SDO_RESPONSE, _read_answer),
            )
        }
        """The handler of each identifier that a drive sends, with its axis."""

    @property
    def waiting(self) -> bool:
        """Never: a frame of the guard's has left when it was handed over."""
        return False

    def axes_of(self, packet: Packet) -> tuple[GuardedAxis, ...]:
        """Return the axis whose set-point this is."""
        axis = self._by_set_point.get(packet.address)
        return () if axis is None else (axis,)

    def requested_by(self, packet: Packet) -> Mapping[InForce, RequestedMotion]:
        """Return what the frame has its axis do."""
        axis = self._by_set_point[packet.address]
        return {axis: axis.requested_by(GuardedSetPoint(*_SET_POINT.unpack(packet.payload)))}

    def permitted(self, axis: Axis) -> str:
        """Describe the targets that an axis of the link may be sent."""
        return next(one.permitted for one in self.axes if one.axis.name == axis.name)

    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Look into the list, and at what is in force."""
        content = self.listed.get(packet.address)
        if content is None:
            return f"identifier 0x{packet.address:X} is not listed"
        reason = content.refuses(packet.payload)
        if reason is not None:
            return reason
        if packet.address == cia301.NMT:
            return self._refuses_command(packet.payload[0], packet.payload[1], now)
        axis = self._by_set_point.get(packet.address)
        if axis is not None:
            return axis.zeroing.refuses_word(_STATUSWORD.unpack_from(packet.payload)[0], by_object=False)
        requested = self._by_request.get(packet.address)
        written = _written(packet.payload)
        return None if requested is None or written is None else self._refuses_write(requested, *written)

    def _refuses_write(self, axis: GuardedAxis, address: Address, raw: bytes) -> str | None:
        """Return why an object whose value is listed may not be written now."""
        # A consumer time of 0 ends the supervision (CiA 301, 0x1016): nothing would stop the drive with the
        # bridge dead.
        if address == CONSUMER_HEARTBEAT_1 and not axis.watch_may_end and not any(raw):
            return f"{CONSUMER_HEARTBEAT_1} set to 0 while node {axis.node} may have power"
        return axis.refuses_write(address, raw, self.axes, by_object=True)

    def _refuses_command(self, command: int, node: int, now: Nanoseconds) -> str | None:
        # NMT start is always permitted: it gives a drive its set-points back, and takes nothing from it.
        for axis in self._addressed(node) if command != NmtCommand.START else ():
            if axis.moving:
                return f"node {axis.node} moves and would receive no more set-points"
            reason = axis.keeps_from_reset(now) if command == NmtCommand.RESET_NODE else None
            if reason is not None:
                return reason
        return None

    def safe(self, axis: GuardedAxis) -> tuple[Packet, ...]:
        """Return the axis's safe frame."""
        return (Packet(self.link, _set_point_id(axis), _SET_POINT.pack(*axis.safe)),)

    def replacement_of(self, packet: Packet) -> tuple[Packet, ...] | None:
        """Return the abort of a request."""
        if packet.address not in self._by_request:
            return None
        # The client waits for an answer: an abort ends its transfer, a missing frame would cost a time-out.
        address = packet.payload[1:4].ljust(3, b"\0")
        abort = bytes((_ABORT,)) + address + _GENERAL_ERROR.to_bytes(4, "little")
        return (Packet(self.link, packet.address, abort),)

    def sends(self, packet: Packet, now: Nanoseconds, *, requested: bool) -> tuple[GuardedAxis, ...]:
        """Note what a frame does to the drives."""
        del requested
        axis = self._by_set_point.get(packet.address)
        if axis is not None:
            axis.sent(GuardedSetPoint(*_SET_POINT.unpack(packet.payload)), now)
            return (axis,)
        if packet.address == cia301.NMT:
            self._commands(packet.payload[0], packet.payload[1])
            return ()
        axis = self._by_request.get(packet.address)
        written = _written(packet.payload)
        if axis is None or written is None:
            return ()
        address, raw = written
        if address != CONTROLWORD:
            axis.wrote(address, raw)
            return ()
        # An object changes the Controlword alone; the target in the drive stays in force.
        axis.sent(GuardedSetPoint(int.from_bytes(raw, "little"), axis.target), now)
        return (axis,)

    def receives(self, packet: Packet, now: Nanoseconds) -> bool:
        """Let everything in; read statusword and position where they come."""
        found = self._readers.get(packet.address)
        if found is not None:
            read, axis = found
            read(axis, packet.payload, now)
        return True

    def _commands(self, command: int, node: int) -> None:
        for axis in self._addressed(node):
            if command in {NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION}:
                axis.restarted()
            elif command != NmtCommand.START:
                # In pre-operational a drive receives no set-points, and keeps none.
                axis.not_receiving()

    def _addressed(self, node: int) -> Iterable[GuardedAxis]:
        return self.axes if node == cia301.ALL_NODES else (self._by_node[node],)


def _listed(
    robot: AnyRobot, link: str, axes: tuple[GuardedAxis, ...], products: Mapping[str, GuardedProduct]
) -> dict[int, Content]:
    table = DriveLink.of_link(robot, link)
    nodes = (cia301.ALL_NODES, *(axis.node for axis in axes))
    states = (NmtState.OPERATIONAL, NmtState.PRE_OPERATIONAL, NmtState.STOPPED, NmtState.BOOT_UP)
    listed: dict[int, Content] = {
        cia301.NMT: Exactly(tuple(bytes((command, node)) for command in LISTED_NMT for node in nodes)),
        cia301.SYNC: Exactly((b"",)),
        cia301.ERROR_CONTROL + table.bridge_node: Exactly(tuple(bytes((one,)) for one in states)),
    }
    for axis in axes:
        product = products[axis.axis.name]
        command, units = axis.axis.command, product.units
        listed[_set_point_id(axis)] = AxisSetPoint(command, axis.targets, units.name(command))
        profile = DriveAxis.of(axis.axis).profile
        if (least := profile.quick_stop_least_rpm_s) is not None:
            listed[cia301.RECEIVE_PDO[BRAKING_PDO] + axis.node] = Braking(
                units.speed(least), units.speed(profile.quick_stop_rpm_s), units.speed_name
            )
        listed[cia301.SDO_REQUEST + axis.node] = SdoRequest(
            writes(axis.axis, product, watch_of(table, table.bridge_node), table.drive_heartbeat_ms)
        )
    return listed


def _set_point_id(axis: GuardedAxis) -> int:
    return _SET_POINT_ID[axis.axis.command] + axis.node


def _read_status(axis: GuardedAxis, payload: bytes, now: Nanoseconds) -> None:
    if len(payload) >= _STATUSWORD.size:
        axis.reports(_STATUSWORD.unpack_from(payload)[0], now)


def _read_sample(axis: GuardedAxis, payload: bytes, now: Nanoseconds) -> None:
    if len(payload) >= _SAMPLE.size:
        statusword, position_qc = _SAMPLE.unpack_from(payload)
        axis.reports(statusword, now)
        axis.reports_position(position_qc, now)


def _read_answer(axis: GuardedAxis, payload: bytes, now: Nanoseconds) -> None:
    uploaded = _uploaded(payload)
    if uploaded is None:
        return
    address, raw = uploaded
    if address == STATUSWORD:
        axis.reports(_STATUSWORD.unpack_from(raw)[0], now)
    else:
        axis.read(address, raw)


def _written(payload: bytes) -> tuple[Address, bytes] | None:
    """Return the object that a request writes, and the value; None for a request of another kind."""
    # 0x23: initiate download, expedited, size given; bits 2 and 3 vary with the size (CiA 301).
    if len(payload) != _SDO_LENGTH or payload[0] & _EXPEDITED_SIZED != _EXPEDITED_SIZED:
        return None
    return _addressed(payload), payload[4 : _SDO_LENGTH - (payload[0] >> 2 & 0b11)]


def _uploaded(payload: bytes) -> tuple[Address, bytes] | None:
    """Return the object of an upload response and four bytes with its value; None for any other frame."""
    if len(payload) != _SDO_LENGTH or payload[0] & _SPECIFIER != _UPLOADED:
        return None
    return _addressed(payload), payload[4:]


def _addressed(payload: bytes) -> Address:
    return Address(int.from_bytes(payload[1:3], "little"), payload[3])
