"""The output guard of EPOS2 drives on maxon's serial protocol: nodes, objects, values.

Commands are answered one by one, in their order; the answers to its own commands the guard keeps to itself. A
command that is not listed here is refused, and so is one with a byte too many.

Source: maxon's command library.
"""

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.objects import CONSUMER_HEARTBEAT_1, CONTROLWORD, POSITION_ACTUAL, STATUSWORD
from firmware_bridge.canopen_drive.guard.axis import GuardedAxis
from firmware_bridge.canopen_drive.guard.values import Values, Writes
from firmware_bridge.canopen_drive.guard.words import (
    CONTROLWORDS,
    LISTED_NMT,
    START_HOMING,
    TARGET,
    GuardedSetPoint,
)
from firmware_bridge.families.epos2.guard.product import product, writes_over_serial
from firmware_bridge.families.epos2.maxon.frame import MaxonAnswer
from firmware_bridge.families.epos2.maxon.messages import (
    ObjectRead,
    ReadObject,
    Request,
    RequestCanFrame,
    SendCanFrame,
    SendNmtService,
    WriteObject,
    address_of,
)
from firmware_bridge.families.epos2.maxon.opcodes import decode_answer, encode_request
from firmware_bridge.families.epos2.maxon.packets import outcome_of, request_of
from firmware_bridge.families.epos2.settings import Epos2Link, nodes_on
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.safety.guard.wire_rules import WireRules
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.can import MAX_PAYLOAD

_RAW: Final = 4
_STATES: Final = (NmtState.OPERATIONAL, NmtState.PRE_OPERATIONAL, NmtState.STOPPED, NmtState.BOOT_UP)
_Judge: TypeAlias = Callable[["Epos2SerialRules", Any, Nanoseconds], str | None]


class Epos2SerialRules(WireRules):
    """Commands that wait for their turn, and one answer for each."""

    axes: tuple[GuardedAxis, ...]

    def __init__(self, robot: AnyRobot, link: str) -> None:
        self.link = link
        self.axes = tuple(GuardedAxis(axis, robot, product(axis, robot)) for axis in robot.axes_on(link))
        bus = Epos2Link.of_link(robot, link)
        self.writes: Final[Mapping[int, Writes]] = {axis.node: _all_writes(axis, robot) for axis in self.axes}
        """The permitted writes, by node."""
        self.beat_id: Final = cia301.ERROR_CONTROL + bus.bridge_node
        """Of the bridge's heartbeat."""
        self.guarding_id: Final = cia301.ERROR_CONTROL + bus.guardian(nodes_on(robot, link))
        """Of the remote frame that has a drive say what the gateway watches."""
        self._by_node = {axis.node: axis for axis in self.axes}
        self._unanswered: deque[tuple[Request | None, bool]] = deque()
        """Each command that has left and has no answer yet, and whether the node waits for it."""

    @property
    def waiting(self) -> bool:
        """True while commands of the guard itself still wait for the line."""
        return not all(requested for _, requested in self._unanswered)

    def axes_of(self, packet: Packet) -> tuple[GuardedAxis, ...]:
        """Return the axis whose controlword or target this writes."""
        axis = self._axis_of(request_of(packet))
        return () if axis is None else (axis,)

    def _axis_of(self, request: Request | None) -> GuardedAxis | None:
        if not isinstance(request, WriteObject):
            return None
        axis = self._by_node.get(request.node)
        return axis if axis is not None and address_of(request) in (CONTROLWORD, _target(axis)) else None

    def requested_by(self, packet: Packet) -> Mapping[InForce, RequestedMotion]:
        """Return what its axis does with what the command writes."""
        request = request_of(packet)
        return {
            axis: axis.requested_by(_written(request, axis))
            for axis in self.axes_of(packet)
            if isinstance(request, WriteObject)
        }

    def permitted(self, axis: Axis) -> str:
        """Describe the targets that an axis of the link may be sent."""
        return next(one.permitted for one in self.axes if one.axis.name == axis.name)

    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Look into the list, and at what is in force."""
        request = request_of(packet)
        judge = None if request is None else _JUDGES.get(type(request))
        if judge is None:
            return f"command 0x{packet.address:02X} '{packet.payload.hex(' ')}' is not listed"
        return judge(self, request, now)

    def safe(self, axis: GuardedAxis) -> tuple[Packet, ...]:
        """Return target 0 for an axis that is commanded by speed, and the Controlword that stops it."""
        word, target = axis.safe
        control = self._writing(axis, CONTROLWORD, word)
        # Target 0 goes first: in profile velocity mode it acts at once, whatever becomes of the second
        # command.
        return (self._writing(axis, _target(axis), target), control) if axis.by_speed else (control,)

    def replacement_of(self, packet: Packet) -> None:
        """Stop every axis, whatever command it is."""

    def sends(self, packet: Packet, now: Nanoseconds, *, requested: bool) -> tuple[GuardedAxis, ...]:
        """Note what a command does to the drives, and whether the node waits for the answer."""
        request = request_of(packet)
        self._unanswered.append((request, requested))
        if isinstance(request, SendNmtService):
            if request.command in {NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION}:
                for addressed in self.addressed(request.node):
                    addressed.restarted()
            return ()
        axis = self._axis_of(request)
        if axis is not None and isinstance(request, WriteObject):
            written = _written(request, axis)
            if address_of(request) == CONTROLWORD:
                axis.sent(written, now)
            else:
                # A target alone can move an axis that is commanded by speed: 0x60FF needs no start bit.
                axis.aims(written.target)
        elif isinstance(request, WriteObject):
            self._by_node[request.node].wrote(address_of(request), request.raw)
        return () if axis is None else (axis,)

    def receives(self, packet: Packet, now: Nanoseconds) -> bool:
        """Let in what is the node's; a line that is gone answers nothing any more."""
        if packet.address in {LINE_LOST, LINE_BACK}:
            # What has left before, or in between, is never answered.
            self._unanswered.clear()
            return True
        if not self._unanswered:
            return False
        request, requested = self._unanswered.popleft()
        if isinstance(request, ReadObject):
            self._reads(request, packet, now)
        return requested

    def addressed(self, node: int) -> Iterable[GuardedAxis]:
        """Return whom a network command is for."""
        return self.axes if node == cia301.ALL_NODES else (self._by_node[node],)

    def refuses_write(self, request: WriteObject, size: int) -> str | None:
        """Return why an object whose value is listed may not be written now."""
        axis, address = self._by_node[request.node], address_of(request)
        return axis.refuses_write(address, request.raw[:size], self.axes, by_object=False)

    def watch_may_end(self, node: int) -> bool:
        """Return whether a listed drive has confirmed that it has no power."""
        return self._by_node[node].watch_may_end

    def _reads(self, request: ReadObject, packet: Packet, now: Nanoseconds) -> None:
        _, outcome = outcome_of(packet)
        answer = decode_answer(request, outcome.body) if isinstance(outcome, MaxonAnswer) else None
        if not isinstance(answer, ObjectRead) or answer.error != 0:
            return
        axis, address = self._by_node[request.node], address_of(request)
        if address == STATUSWORD:
            # An answer always has four bytes, and those behind a 16-bit value are random in a real drive.
            axis.reports(DataType.UNSIGNED16.decode(answer.raw[:2]), now)
        elif address == POSITION_ACTUAL:
            axis.reports_position(DataType.INTEGER32.decode(answer.raw), now)
        else:
            axis.read(address, answer.raw)

    def _writing(self, axis: GuardedAxis, address: Address, value: int) -> Packet:
        # Two's complement in 32 bits: WriteObject carries four bytes, whatever the object's size.
        raw = (value & 0xFFFF_FFFF).to_bytes(_RAW, "little")
        frame = encode_request(WriteObject(address.index, address.subindex, axis.node, raw))
        return Packet(self.link, frame.opcode, frame.body)


def _all_writes(axis: GuardedAxis, robot: AnyRobot) -> Writes:
    homing = () if axis.axis.travel is None else (START_HOMING,)
    return {
        **writes_over_serial(axis.axis, robot),
        CONTROLWORD: Values(DataType.UNSIGNED16, (*CONTROLWORDS[axis.axis.command], *homing)),
        _target(axis): Values(DataType.INTEGER32, axis.targets),
    }


def _target(axis: GuardedAxis) -> Address:
    return TARGET[axis.axis.command]


def _written(request: WriteObject, axis: GuardedAxis) -> GuardedSetPoint:
    """Return what is in force at an axis when its controlword or target was written."""
    word, target = axis.set_point
    if address_of(request) == CONTROLWORD:
        return GuardedSetPoint(DataType.UNSIGNED32.decode(request.raw), target)
    return GuardedSetPoint(word, DataType.INTEGER32.decode(request.raw))


def _read(rules: Epos2SerialRules, request: ReadObject, _now: Nanoseconds) -> str | None:
    return None if request.node in rules.writes else f"node {request.node} is not listed"


def _write(rules: Epos2SerialRules, request: WriteObject, _now: Nanoseconds) -> str | None:
    writes = rules.writes.get(request.node)
    if writes is None:
        return f"node {request.node} is not listed"
    address = address_of(request)
    values = writes.get(address)
    if values is None:
        return f"{address} is not an object that may be written"
    size = values.type.size
    if any(request.raw[size:]):
        return f"{address} written with more than its {size} bytes"
    if (
        address == CONSUMER_HEARTBEAT_1
        and request.raw == bytes(_RAW)
        and not rules.watch_may_end(request.node)
    ):
        return f"{address} set to 0 while node {request.node} may have power"
    return values.refuses(address, request.raw[:size]) or rules.refuses_write(request, size)


def _command(rules: Epos2SerialRules, request: SendNmtService, now: Nanoseconds) -> str | None:
    if request.node != cia301.ALL_NODES and request.node not in rules.writes:
        return f"node {request.node} is not listed"
    if request.command not in LISTED_NMT:
        return f"network command {request.command} is not listed"
    for axis in rules.addressed(request.node) if request.command != NmtCommand.START else ():
        if axis.moving:
            return f"node {axis.node} moves and would look as if it had restarted"
        reason = axis.keeps_from_reset(now) if request.command == NmtCommand.RESET_NODE else None
        if reason is not None:
            return reason
    return None


def _frame(rules: Epos2SerialRules, request: SendCanFrame, _now: Nanoseconds) -> str | None:
    # SendCANFrame always carries eight bytes, whatever its length field.
    beats = tuple(bytes((state,)).ljust(MAX_PAYLOAD, b"\0") for state in _STATES)
    if request.identifier == rules.beat_id and request.length == 1 and request.raw in beats:
        return None
    content = request.raw[: request.length].hex(" ")
    return f"frame 0x{request.identifier:X} '{content}' is not listed"


def _remote(rules: Epos2SerialRules, request: RequestCanFrame, _now: Nanoseconds) -> str | None:
    guarding = request.identifier == rules.guarding_id
    return None if guarding else f"remote frame 0x{request.identifier:X} is not listed"


_JUDGES: Final[Mapping[type[Request], _Judge]] = MappingProxyType(
    {
        ReadObject: _read,
        WriteObject: _write,
        SendNmtService: _command,
        SendCanFrame: _frame,
        RequestCanFrame: _remote,
    }
)
"""No segmented transfer: nothing that the bridge writes or needs is longer than four bytes."""
