"""The adapter between a computer and a drive's serial port: it can be unplugged in the middle of a run."""

from firmware_bridge.node import LINE_BACK, LINE_LOST, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds


class Adapter:
    """Adapter around a node, on one of its links: while unplugged it blocks packets, and reports so.

    The node learns it at its next turn, as from a port of the real runtime.
    """

    def __init__(self, node: Node, link: str) -> None:
        self._link = link
        self.node = node
        self.plugged = True
        """False once a fault has pulled the plug; set from outside."""
        self._reported = True

    @property
    def holding(self) -> bool:
        """True if the node still holds something after the request to end."""
        return holds(self.node)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Forward a packet, unless it is of a line that is unplugged."""
        if packet.link == self._link and not self.plugged:
            # The packet is lost, the time is not: the node does what is due, and learns of the plug.
            return self.wake(now)
        before = self._reports(now)
        return self._left(before, self.node.receive(packet, now))

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node."""
        before = self._reports(now)
        return self._left(before, self.node.wake(now))

    def stop(self, now: Nanoseconds) -> Reaction:
        """Request the node to end."""
        return self._left((), self.node.stop(now)) if isinstance(self.node, Stoppable) else Reaction()

    def _reports(self, now: Nanoseconds) -> tuple[Packet, ...]:
        if self._reported is self.plugged:
            return ()
        self._reported = self.plugged
        # Reported before the packet in hand, as the runtime's port does it.
        event = LINE_BACK if self.plugged else LINE_LOST
        return self.node.receive(Packet(self._link, event, b""), now).sent

    def _left(self, before: tuple[Packet, ...], reaction: Reaction) -> Reaction:
        sent = before + reaction.sent
        if not self.plugged:
            # What is written to a port that is gone is lost.
            sent = tuple(packet for packet in sent if packet.link != self._link)
        return Reaction(sent, reaction.wake_at)
