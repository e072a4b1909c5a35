"""The guard's understanding of a serial line: commands, one answer for each, in their order.

Of what comes back it keeps the answers to its own commands to itself.
"""

from collections import deque
from collections.abc import Iterable
from typing import Final

from firmware_bridge.node import LINE_BACK, LINE_LOST, MAXON
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Mode
from firmware_bridge.safety.guard_axis import GuardedAxis
from firmware_bridge.safety.guard_rules import ENABLE, HALT
from firmware_bridge.safety.guard_serial_rules import TARGET, SerialRules
from firmware_bridge.safety.guard_speech import Speech
from firmware_bridge.wire import canopen
from firmware_bridge.wire.canopen import NmtCommand
from firmware_bridge.wire.epos2.address import CONSUMER_HEARTBEAT_1, CONTROLWORD, Address
from firmware_bridge.wire.epos2.rows import DataType
from firmware_bridge.wire.maxon.messages import SendNmtService, WriteObject, address_of
from firmware_bridge.wire.maxon.packets import command, request_of

_RAW: Final = 4


class SerialSpeech(Speech):
    """Commands that wait for their turn, and one answer for each."""

    def __init__(self, rules: SerialRules) -> None:
        self.link = MAXON
        self.cycle = rules.cycle
        self.axes = tuple(GuardedAxis(axis) for axis in rules.axes)
        self._rules = rules
        self._by_node = {axis.rules.axis.node: axis for axis in self.axes}
        self._asked: deque[bool] = deque()
        """Of each command that has left and has no answer yet: whether the node waits for it."""

    @property
    def speaking(self) -> bool:
        """Whether words of the guard itself still wait for the line."""
        return not all(self._asked)

    def axis_of(self, packet: Packet) -> GuardedAxis | None:
        """Return the axis whose controlword or target this writes."""
        request = request_of(packet)
        if not isinstance(request, WriteObject):
            return None
        axis = self._by_node.get(request.node)
        return axis if axis is not None and address_of(request) in _set_point(axis) else None

    def refuses(self, packet: Packet) -> str | None:
        """Look into the list, and at what the drives were told before."""
        reason = self._rules.refuses(packet)
        if reason is not None:
            return reason
        request = request_of(packet)
        if isinstance(request, SendNmtService) and request.command != NmtCommand.START:
            for axis in self._addressed(request.node):
                if axis.under_way:
                    return f"node {axis.rules.axis.node} moves and would look as if it had restarted"
        if isinstance(request, WriteObject) and self._by_node[request.node].powered and _ends_watch(request):
            return f"{CONSUMER_HEARTBEAT_1} set to 0 while node {request.node} has power"
        return None

    def learn(self, packet: Packet) -> None:
        """Remember what an admitted command does to the drives."""
        request = request_of(packet)
        if isinstance(request, SendNmtService):
            if request.command in {NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION}:
                for axis in self._addressed(request.node):
                    axis.word = 0
        elif isinstance(request, WriteObject):
            axis = self._by_node[request.node]
            if address_of(request) == CONTROLWORD:
                axis.word = DataType.UNSIGNED32.decode(request.raw)
            elif address_of(request) == TARGET[axis.rules.axis.mode]:
                axis.target = DataType.INTEGER32.decode(request.raw)

    def in_place_of(self, packet: Packet) -> tuple[Packet, ...]:
        """Return the safe words: of its axis for a part of a set-point, else of every axis with power."""
        axis = self.axis_of(packet)
        if axis is not None:
            return self.safe(axis)
        return tuple(safe for axis in self.axes if axis.powered for safe in self.safe(axis))

    def safe(self, axis: GuardedAxis) -> tuple[Packet, ...]:
        """Return target 0 for a velocity axis, and the word that stops it; an axis without power stays so."""
        if axis.rules.axis.mode is Mode.VELOCITY:
            word = ENABLE if axis.powered else axis.word
            return _writing(axis, TARGET[Mode.VELOCITY], 0), _writing(axis, CONTROLWORD, word)
        return (_writing(axis, CONTROLWORD, HALT if axis.powered else axis.word),)

    def leaves(self, _packet: Packet, *, asked: bool) -> None:
        """Note whether the node waits for the answer."""
        self._asked.append(asked)

    def passes(self, packet: Packet) -> bool:
        """Let in what is the node's; a line that is gone answers nothing any more."""
        if packet.address in {LINE_LOST, LINE_BACK}:
            # What has left before, or in between, is never answered.
            self._asked.clear()
            return True
        return bool(self._asked) and self._asked.popleft()

    def _addressed(self, node: int) -> Iterable[GuardedAxis]:
        return self.axes if node == canopen.ALL_NODES else (self._by_node[node],)


def _set_point(axis: GuardedAxis) -> tuple[Address, Address]:
    return CONTROLWORD, TARGET[axis.rules.axis.mode]


def _writing(axis: GuardedAxis, address: Address, value: int) -> Packet:
    raw = value.to_bytes(_RAW, "little")
    return command(WriteObject(address.index, address.subindex, axis.rules.axis.node, raw))


def _ends_watch(request: WriteObject) -> bool:
    return address_of(request).index == CONSUMER_HEARTBEAT_1.index and request.raw == bytes(_RAW)
