"""The CAN bus as the bridge's link: SYNC makes the drives tell, the heartbeat tells of the bridge."""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.drivers.epos2 import Epos2
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Bus
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from firmware_bridge.wire import can, canopen
from firmware_bridge.wire.canopen import NODE_MASK, NmtState

ANSWERS_WITHIN: Final[Nanoseconds] = 10 * MILLISECOND
"""The drives answer a SYNC within a millisecond; later ones are not waited for."""


class CanLink:
    """A `firmware_bridge.drivers.link.Link`."""

    __slots__ = ("_beat", "_by_node", "_drives", "answers_within", "late", "lost", "name", "wake_at")

    def __init__(self, drives: Iterable[Epos2], bus: Bus) -> None:
        self.name = CAN
        self.answers_within = ANSWERS_WITHIN
        self.late = 0
        """Always: the samples of a cycle leave at its SYNC."""
        self.lost: str | None = None
        """Always None: a port that loses its bus ends the program."""
        self.wake_at: Nanoseconds = NEVER
        self._drives = tuple(drives)
        self._by_node = {drive.axis.node: drive for drive in self._drives}
        beat = canopen.encode_heartbeat(NmtState.OPERATIONAL)
        self._beat = Packet(CAN, canopen.ERROR_CONTROL + bus.bridge_node, beat)

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Send SYNC."""
        for drive in self._drives:
            drive.synchronised(now)
        return (Packet(CAN, canopen.SYNC, b""),)

    def beat(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Send the bridge's heartbeat."""
        return (self._beat,)

    def hear(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a frame; those of strangers, remote requests and error reports are ignored."""
        if packet.address & ~can.STANDARD_MASK:
            return ()
        drive = self._by_node.get(packet.address & NODE_MASK)
        return () if drive is None else drive.hear(packet, now)

    def wake(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Do nothing."""
        return ()
