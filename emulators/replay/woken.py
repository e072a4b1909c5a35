"""A bridge by a real machine's clock: woken when the recorded one was, which was a little late each time.

The times of those wakes follow from its packets; where it has sent nothing it is woken at the time that it
requested. As on a real machine, a packet that has arrived by an instant is received before anything that is
due then.
"""

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable
from typing import Final

from firmware_bridge.node import Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds


class Woken:
    """Wrapper of a node whose wakes come at the next instant at which it has spoken, up to `late` later."""

    def __init__(
        self, node: Node, spoke: Iterable[Nanoseconds], received: Iterable[Nanoseconds], late: Nanoseconds
    ) -> None:
        self._node: Final = node
        self._spoke: Final = sorted(set(spoke))
        self._received: Final = Counter(received)
        """Number of packets still to come at an instant."""
        self._late: Final = late

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Deliver a packet; actions due by then come in the same turn."""
        # Of several packets at one instant each is received before the node is woken.
        self._received[now] -= 1
        reaction = self._node.receive(packet, now)
        return reaction if reaction.wake_at <= now else self._later(reaction, reaction.wake_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node, unless a packet comes now that it has to receive first."""
        if self._received[now] > 0:
            return Reaction((), now)
        reaction = self._node.wake(now)
        # What is due at once comes a turn later, and a turn takes time.
        return self._later(reaction, max(reaction.wake_at, now + 1))

    def _later(self, reaction: Reaction, requested: Nanoseconds) -> Reaction:
        place = bisect_left(self._spoke, requested)
        if place == len(self._spoke) or self._spoke[place] - requested > self._late:
            return reaction
        return Reaction(reaction.sent, self._spoke[place])
