"""The guard's understanding of CAN: frames by their identifiers."""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.safety.guard_axis import GuardedAxis
from firmware_bridge.safety.guard_rules import Rules
from firmware_bridge.safety.guard_speech import Speech
from firmware_bridge.wire import canopen
from firmware_bridge.wire.canopen import NmtCommand
from firmware_bridge.wire.epos2.address import CONSUMER_HEARTBEAT_1, CONTROLWORD

_SDO_ABORT: Final = 0x80
_SDO_DOWNLOAD: Final = 0x23
_GENERAL_ERROR: Final = 0x0800_0000


class CanSpeech(Speech):
    """Frames that leave when they are handed over, and answers that everybody finds by himself."""

    def __init__(self, rules: Rules) -> None:
        self.link = CAN
        self.cycle = rules.cycle
        self.axes = tuple(GuardedAxis(axis) for axis in rules.axes)
        self._rules = rules
        self._by_set_point = {axis.rules.set_point_id: axis for axis in self.axes}
        self._by_sdo = {axis.rules.sdo_id: axis for axis in self.axes}
        self._by_node = {axis.rules.axis.node: axis for axis in self.axes}

    @property
    def speaking(self) -> bool:
        """Never: a frame of the guard's has left when it was handed over."""
        return False

    def axis_of(self, packet: Packet) -> GuardedAxis | None:
        """Return the axis whose set-point this is."""
        return self._by_set_point.get(packet.address)

    def refuses(self, packet: Packet) -> str | None:
        """Look into the list, and at what the drives were told before."""
        reason = self._rules.refuses(packet)
        if reason is not None:
            return reason
        if packet.address == canopen.NMT and packet.payload[0] != NmtCommand.START:
            for axis in self._addressed(packet.payload[1]):
                if axis.under_way:
                    return f"node {axis.rules.axis.node} moves and would no longer hear set-points"
        requested = self._by_sdo.get(packet.address)
        if requested is not None and requested.powered and _ends_watch(packet.payload):
            return f"{CONSUMER_HEARTBEAT_1} set to 0 while node {requested.rules.axis.node} has power"
        return None

    def learn(self, packet: Packet) -> None:
        """Remember what an admitted frame does to the drives."""
        axis = self._by_set_point.get(packet.address)
        if axis is not None:
            axis.told(packet.payload)
        elif packet.address == canopen.NMT:
            # A drive that hears no set-points keeps none; it starts anew without power.
            if packet.payload[0] != NmtCommand.START:
                for addressed in self._addressed(packet.payload[1]):
                    addressed.word = 0
        elif packet.address in self._by_sdo and _writes(packet.payload, CONTROLWORD.index):
            self._by_sdo[packet.address].word = int.from_bytes(packet.payload[4:6], "little")

    def in_place_of(self, packet: Packet) -> tuple[Packet, ...]:
        """Return the safe frames: for a set-point its axis's, for a request its abort, else every axis's."""
        axis = self._by_set_point.get(packet.address)
        if axis is not None:
            return (axis.safe(),)
        if packet.address in self._by_sdo:
            address = packet.payload[1:4].ljust(3, b"\0")
            abort = bytes((_SDO_ABORT,)) + address + _GENERAL_ERROR.to_bytes(4, "little")
            return (Packet(CAN, packet.address, abort),)
        return tuple(axis.safe() for axis in self.axes if axis.powered)

    def safe(self, axis: GuardedAxis) -> tuple[Packet, ...]:
        """Return the axis's safe frame."""
        return (axis.safe(),)

    def leaves(self, packet: Packet, *, asked: bool) -> None:
        """Do nothing: on a bus everybody finds his own answers."""

    def passes(self, _packet: Packet) -> bool:
        """Let everything in."""
        return True

    def _addressed(self, node: int) -> Iterable[GuardedAxis]:
        return self.axes if node == canopen.ALL_NODES else (self._by_node[node],)


def _ends_watch(payload: bytes) -> bool:
    return _writes(payload, CONSUMER_HEARTBEAT_1.index) and payload[4:] == bytes(4)


def _writes(payload: bytes, index: int) -> bool:
    return payload[0] & _SDO_DOWNLOAD == _SDO_DOWNLOAD and payload[1:3] == index.to_bytes(2, "little")
