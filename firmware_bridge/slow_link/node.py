"""A node with a slow link before it: what comes and goes there is late, lost or doubled; the rest is not.

It may stand before the bridge or before an operator. Its chance is drawn four times for each packet, whatever
the conditions are, so that one key more leaves the others' chance as it is.
"""

import heapq
from typing import Final, Protocol

from firmware_bridge.node import Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.slow_link.conditions import Conditions, LinkDirection
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

BITS_A_BYTE: Final = 10
"""On a serial line: start, eight, stop."""


class Chance(Protocol):
    """A source of random numbers: a seeded generator."""

    def random(self) -> float:
        """Return the next number, from 0 up to 1."""


class Pipe:
    """One way of a link."""

    __slots__ = ("_bad", "_chance", "_direction", "_flying", "_free_at", "_number", "carried", "lost")

    def __init__(self, direction: LinkDirection, chance: Chance) -> None:
        self._direction: Final = direction
        self._chance: Final = chance
        self._flying: Final[list[tuple[Nanoseconds, int, Packet]]] = []
        self._number = 0
        self._free_at: Nanoseconds = 0
        """Time when its line has sent everything."""
        self._bad = False
        """A burst of losses is going on."""
        self.carried = 0
        self.lost = 0

    @property
    def next_at(self) -> Nanoseconds:
        """Arrival of the next packet."""
        return self._flying[0][0] if self._flying else NEVER

    def put(self, packet: Packet, now: Nanoseconds) -> None:
        """Send a packet on its way, or lose it."""
        direction = self._direction
        falls, late, again, later = (self._chance.random() for _ in range(4))
        self.carried += 1
        # The state of Gilbert's model goes on with every packet, also with one that the queue loses.
        lost = self._loses(falls)
        sent_at = now
        if direction.bandwidth:
            begins = max(now, self._free_at)
            if begins - now > direction.queue:
                self.lost += 1
                return
            sent_at = self._free_at = begins + round(
                len(packet.payload) * BITS_A_BYTE * SECOND / direction.bandwidth
            )
        if lost:
            self.lost += 1
            return
        self._fly(packet, sent_at + direction.delay + round(late * direction.jitter))
        if again < direction.duplicate:
            self._fly(packet, sent_at + direction.delay + round(later * direction.jitter))

    def arrived(self, now: Nanoseconds) -> list[Packet]:
        """Take out what has arrived by now, in the order of the instants."""
        packets = []
        while self._flying and self._flying[0][0] <= now:
            packets.append(heapq.heappop(self._flying)[2])
        return packets

    def clear(self) -> None:
        """Forget what is under way."""
        self._flying.clear()

    def _fly(self, packet: Packet, at: Nanoseconds) -> None:
        self._number += 1
        # The number keeps packets of one instant in order: packets themselves have none.
        heapq.heappush(self._flying, (at, self._number, packet))

    def _loses(self, falls: float) -> bool:
        """Return whether this packet is lost: Gilbert's two states, or each packet by itself."""
        direction = self._direction
        if not direction.burst:
            return falls < direction.loss
        if direction.loss < 1.0:
            # Bursts of mean length b, good runs of mean length b (1 - p) / p: together the share p is lost.
            begins = direction.loss / (direction.burst * (1.0 - direction.loss))
            self._bad = falls < (1.0 - 1.0 / direction.burst if self._bad else begins)
        return self._bad


class SlowLink:
    """A slow link at one of a node's links: `into` carries the received packets, `out` the sent ones."""

    def __init__(self, node: Node, link: str, *, into: Pipe, out: Pipe) -> None:
        self.node: Final = node
        self.into: Final = into
        self.out: Final = out
        self._link: Final = link
        self._wake_at: Nanoseconds = 0
        """Time of the node's own next wake-up."""
        self._passing: list[Packet] = []
        """Packets on other links, which leave at once."""
        self._stopping = False

    @property
    def holding(self) -> bool:
        """True while the node keeps the robot from moving after a command to end."""
        return holds(self.node)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Let a packet of the link wait for its time; any other comes at once."""
        if packet.link == self._link:
            self.into.put(packet, now)
        else:
            self._take(self.node.receive(packet, now), now)
        return self._turn(now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Bring what has arrived, wake the node where that is due, and let out what is due."""
        return self._turn(now, wakes=True)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Command the node to end; its last packets go through the slow link, too."""
        self._stopping = True
        self._take(self.node.stop(now) if isinstance(self.node, Stoppable) else Reaction(), now)
        return self._turn(now)

    def _turn(self, now: Nanoseconds, *, wakes: bool = False) -> Reaction:
        for packet in self.into.arrived(now):
            self._take(self.node.receive(packet, now), now)
        if wakes and now >= self._wake_at:
            self._take(self.node.wake(now), now)
        if self._stopping and self._wake_at == NEVER:
            self.into.clear()  # no receiver is left
        sent = (*self._passing, *self.out.arrived(now))
        self._passing = []
        return Reaction(sent, min(self._wake_at, self.into.next_at, self.out.next_at))

    def _take(self, reaction: Reaction, now: Nanoseconds) -> None:
        self._wake_at = reaction.wake_at
        for packet in reaction.sent:
            if packet.link == self._link:
                self.out.put(packet, now)
            else:
                self._passing.append(packet)


def before_robot(node: Node, link: str, how: Conditions, up: Chance, down: Chance) -> SlowLink:
    """Put a slow link before a bridge: what comes to it comes from the operator."""
    return SlowLink(node, link, into=Pipe(how.up, up), out=Pipe(how.down, down))


def before_operator(node: Node, link: str, how: Conditions, up: Chance, down: Chance) -> SlowLink:
    """Put a slow link before an operator, whose commands go up to the robot."""
    return SlowLink(node, link, into=Pipe(how.down, down), out=Pipe(how.up, up))
