"""Several emulated devices and their physics as one node, so that the runner can carry them on a real bus.

Between its members packets are exchanged at once; the real bus carries them to all others. Faults are put on
it as on a bench: see `emulators.bench.faults.site.Carrier`.
"""

from bisect import insort
from collections import deque
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from firmware_bridge.node import CAN, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

if TYPE_CHECKING:
    from emulators.world import Physics

ON_CAN: Final[Mapping[str, str]] = MappingProxyType({CAN: CAN})


OUTSIDE: Final = ""
"""Name of the others on the real bus, as the sender of a packet."""
Loses: TypeAlias = Callable[[str, str | None, str], bool]
"""Return whether a packet is lost: its sender, its receiver (None: on its way to all), and its link."""


class _Member:
    """A node in the cluster, its links, when it wants to be woken, and from when on it is cut off."""

    __slots__ = ("inner", "name", "node", "outer", "silent_from", "wake_at")

    def __init__(self, name: str, node: Node, links: Mapping[str, str]) -> None:
        self.name = name
        self.node = node
        self.outer = dict(links)
        """Outer names of the node's links."""
        self.inner = {outer: inner for inner, outer in links.items()}
        self.wake_at: Nanoseconds = 0
        self.silent_from: Nanoseconds = NEVER


class Cluster:
    """One node made of many. The physics is moved on at every call, and at least once in `poll`."""

    def __init__(
        self,
        members: Mapping[str, Node],
        physics: "Physics | None" = None,
        poll: Nanoseconds = MILLISECOND,
        links: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
    ) -> None:
        """Take the members; `links` has for each member the outer names of its links.

        A member that is not in it has one link, CAN, under its own name. Members with one link in common
        receive each other's packets on it.
        """
        self._members = {name: _Member(name, node, links.get(name, ON_CAN)) for name, node in members.items()}
        self._physics = physics
        self._poll = poll
        self._outbox: list[Packet] = []
        self._between: deque[tuple[_Member | None, Packet]] = deque()
        self._agenda: list[tuple[Nanoseconds, int, Callable[[Any], None], Any]] = []
        self._sequence = 0
        self.now: Nanoseconds = 0
        """The newest instant that is known."""
        self.loses: Loses | None = None
        """The disturbances on its links."""

    def call_at(self, at: Nanoseconds, call: Callable[[Any], None], argument: object = None) -> None:
        """Call back at an instant."""
        self._sequence += 1
        insort(self._agenda, (at, self._sequence, call, argument))

    def send(self, link: str, packet: Packet) -> None:
        """Put a packet of a foreign node on a link, now."""
        packet = _renamed(packet, link)
        self._outbox.append(packet)
        self._between.append((None, packet))

    def report(self, link: str, state: int) -> None:
        """Report to a line's port what became of its cable, `LINE_LOST` or `LINE_BACK`."""
        self._outbox.append(Packet(link, state, b""))

    def here(self, name: str) -> bool:
        """Return whether there is a member of this name."""
        return name in self._members

    def links(self, name: str) -> Mapping[str, str]:
        """Return the outer names of a member's links; KeyError."""
        return dict(self._members[name].outer)

    def detach(self, name: str) -> None:
        """Remove a member: it neither receives, nor sends, nor is woken. KeyError."""
        del self._members[name]

    def attach(self, name: str, node: Node, links: Mapping[str, Any]) -> None:
        """Put a node on links, by the names that it has for them; it is first woken now."""
        member = self._members[name] = _Member(name, node, links)
        member.wake_at = self.now

    def rouse(self, name: str) -> None:
        """Wake a member now: something was done to it that it has to act on. KeyError."""
        self._members[name].wake_at = self.now

    def silence(self, name: str, from_time: Nanoseconds) -> None:
        """Cut a member off the bus from an instant on; it lives on. KeyError for a name that is not there."""
        self._members[name].silent_from = from_time

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Move the physics to now and give the packet to every member that is on its link."""
        self._advance(now)
        if self.loses is None or not self.loses(OUTSIDE, None, packet.link):
            for member in self._members.values():
                self._give(member, packet, now)
        return self._reaction(now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Move the physics to now and wake the members that are due, the one that has waited longest first.

        Where the machine was busy, an answer comes before the timeout of the member that waits for it.
        """
        self._advance(now)
        self._wake_those_due(now)
        return self._reaction(now)

    def _advance(self, now: Nanoseconds) -> None:
        """Move on to now; what is to be called before has its own instant."""
        while self._agenda and self._agenda[0][0] <= now:
            at, _, call, argument = self._agenda.pop(0)
            self.now = max(at, self.now)
            self._move(self.now)
            # A device may move its motors itself as it is woken: what is changed begins now, not before.
            for member in self._members.values():
                member.wake_at = min(member.wake_at, self.now)
            self._wake_those_due(self.now)
            call(argument)
            self._exchange(self.now)
        self.now = now
        self._move(now)

    def _wake_those_due(self, now: Nanoseconds) -> None:
        # By time, then by name: members that are due at once always come in the same order.
        for _, name in sorted((it.wake_at, name) for name, it in self._members.items() if it.wake_at <= now):
            member = self._members[name]
            if member.wake_at <= now:
                member.wake_at = NEVER
                self._take(member, member.node.wake(now), now)
                self._exchange(now)

    def _move(self, now: Nanoseconds) -> None:
        """Move the physics on."""
        if self._physics is None:
            return
        while True:
            reached, names = self._physics.advance(now)
            if not names:
                return
            for name in names:
                member = self._members.get(name)
                if member is not None:
                    # At the event's own instant, which may lie before `now` on a busy machine.
                    self._take(member, member.node.wake(reached), reached)
            self._exchange(reached)

    def _take(self, member: _Member, reaction: Reaction, now: Nanoseconds) -> None:
        member.wake_at = reaction.wake_at
        if reaction.sent and now < member.silent_from:
            sent = [_renamed(packet, member.outer[packet.link]) for packet in reaction.sent]
            if self.loses is not None:
                sent = [one for one in sent if not self.loses(member.name, None, one.link)]
            self._outbox.extend(sent)
            self._between.extend((member, packet) for packet in sent)

    def _exchange(self, now: Nanoseconds) -> None:
        """Exchange packets among the members, until none has anything to add."""
        between = self._between
        while between:
            # First in, first out: answers keep the order of their causes.
            sender, packet = between.popleft()
            for member in tuple(self._members.values()):
                if member is not sender:
                    self._give(member, packet, now)

    def _give(self, member: _Member, packet: Packet, now: Nanoseconds) -> None:
        """Deliver to a member a packet of a link that it is on."""
        link = member.inner.get(packet.link)
        if link is not None and now < member.silent_from:
            if self.loses is not None and self.loses(OUTSIDE, member.name, packet.link):
                return
            self._take(member, member.node.receive(_renamed(packet, link), now), now)

    def _reaction(self, now: Nanoseconds) -> Reaction:
        self._exchange(now)
        wake_at = min((member.wake_at for member in self._members.values()), default=NEVER)
        if self._agenda:
            wake_at = min(wake_at, self._agenda[0][0])
        if self._physics is not None:
            # The physics raises events between packets: it must not wait for the next one.
            wake_at = min(wake_at, now + self._poll)
        sent = tuple(self._outbox)
        self._outbox.clear()
        return Reaction(sent, wake_at)


def _renamed(packet: Packet, link: str) -> Packet:
    return packet if packet.link == link else Packet(link, packet.address, packet.payload)
