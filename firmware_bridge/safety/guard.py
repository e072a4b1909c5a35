"""The guard: the last look at every CAN frame that leaves; behind it is only the wire.

It shares no state with the interlocks and trusts nothing before it: what may leave stands in
`firmware_bridge.safety.guard_rules`. A refusal puts the safe frame in the place of the refused one, because
a velocity drive that hears nothing keeps its last target. Operator datagrams pass untouched. It sends no
heartbeat: a bridge that hangs is also stopped by the drives' own watch.
"""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.node import CAN, OPERATOR, Node, Packet, Reaction, Stoppable
from firmware_bridge.safety.guard_axis import GuardedAxis
from firmware_bridge.safety.guard_rules import Rules
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.canopen import NmtCommand
from firmware_bridge.wire.epos2.address import CONSUMER_HEARTBEAT_1, CONTROLWORD

SILENT_CYCLES: Final = 3
"""So many cycles without a set-point for an axis that was told to move, and the guard speaks itself."""
REMEMBERED: Final = 100
"""The newest refusals that are kept; all are counted."""

_SDO_ABORT: Final = 0x80
_SDO_DOWNLOAD: Final = 0x23
_GENERAL_ERROR: Final = 0x0800_0000


@dataclass(frozen=True, slots=True)
class Refusal:
    """One frame that did not leave, or one silence that the guard filled."""

    at: Nanoseconds
    packet: Packet | None
    """None: nothing was refused, the bridge was silent or failed."""
    reason: str
    sent: tuple[Packet, ...]
    """What left in its place."""


Listener: TypeAlias = Callable[[Refusal], None]


class Guarded:
    """A node behind the guard; itself a node that can be stopped."""

    def __init__(self, node: Node, rules: Rules, listener: Listener | None = None) -> None:
        self.node = node
        self.refused = 0
        """Refusals so far."""
        self._rules = rules
        self._listener = listener
        self._refusals: deque[Refusal] = deque(maxlen=REMEMBERED)
        self._axes = tuple(GuardedAxis(axis) for axis in rules.axes)
        self._by_set_point = {axis.rules.set_point_id: axis for axis in self._axes}
        self._by_sdo = {axis.rules.sdo_id: axis for axis in self._axes}
        self._by_node = {axis.rules.axis.node: axis for axis in self._axes}
        self._patience: Final = SILENT_CYCLES * rules.cycle
        self._moving_since: Nanoseconds = NEVER
        """Since when some axis has been told to move; NEVER while none is."""
        self._speak_at: Nanoseconds = NEVER
        """When the guard repeats itself while the bridge stays silent; NEVER while it does not."""
        self._stopping = False

    @property
    def refusals(self) -> tuple[Refusal, ...]:
        """The newest refusals, oldest first."""
        return tuple(self._refusals)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Pass a packet on, and judge what the node sends."""
        return self._judged(self.node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node, judge what it sends, and speak for it when it is silent."""
        return self._judged(self.node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Pass the wish to end on, and judge what the node sends; a node that cannot stop is made safe."""
        self._stopping = True
        if not isinstance(self.node, Stoppable):
            return Reaction(self._all_safe())
        try:
            reaction = self.node.stop(now)
        except Exception as error:  # noqa: BLE001 - whatever broke the bridge, the drives must hear something
            reason = f"the bridge failed while stopping: {error!r}"
            return Reaction(self._replaced(None, reason, self._all_safe(), now))
        return self._judged(reaction, now)

    def _judged(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        sent: list[Packet] = []
        for packet in reaction.sent:
            if packet.link == OPERATOR:
                sent.append(packet)
            elif packet.link == CAN:
                sent += self._admitted(packet, now)
            else:
                sent += self._replaced(packet, f"link '{packet.link}' is not listed", self._all_safe(), now)
        if self._stopping and reaction.wake_at == NEVER:
            # It has ended in good order; whoever carries it takes NEVER for the end.
            return Reaction(tuple(sent))
        sent += self._spoken_for(now)
        return Reaction(tuple(sent), min(reaction.wake_at, self._deadline()))

    def _admitted(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return the frame itself, or what leaves in its place."""
        if (axis := self._by_set_point.get(packet.address)) is not None:
            axis.spoken_at = now
        reason = self._refuses(packet)
        if reason is None:
            self._learn(packet)
            return (packet,)
        return self._replaced(packet, reason, self._in_place_of(packet), now)

    def _replaced(
        self, packet: Packet | None, reason: str, safe: tuple[Packet, ...], now: Nanoseconds
    ) -> tuple[Packet, ...]:
        for frame in safe:
            self._learn(frame)
        refusal = Refusal(now, packet, reason, safe)
        self.refused += 1
        self._refusals.append(refusal)
        if self._listener is not None:
            self._listener(refusal)
        return safe

    def _refuses(self, packet: Packet) -> str | None:
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

    def _learn(self, packet: Packet) -> None:
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

    def _in_place_of(self, packet: Packet) -> tuple[Packet, ...]:
        """Return the safe frames: for a set-point its axis's, for a request its abort, else every axis's."""
        axis = self._by_set_point.get(packet.address)
        if axis is not None:
            return (axis.safe(),)
        if packet.address in self._by_sdo:
            address = packet.payload[1:4].ljust(3, b"\0")
            abort = bytes((_SDO_ABORT,)) + address + _GENERAL_ERROR.to_bytes(4, "little")
            return (Packet(CAN, packet.address, abort),)
        return self._all_safe()

    def _all_safe(self) -> tuple[Packet, ...]:
        return tuple(axis.safe() for axis in self._axes if axis.powered)

    def _addressed(self, node: int) -> Iterable[GuardedAxis]:
        return self._axes if node == canopen.ALL_NODES else (self._by_node[node],)

    def _spoken_for(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return safe demands for all axes when some axis moves and some axis was forgotten for too long."""
        alarmed = self._speak_at != NEVER
        if not alarmed and not any(axis.under_way for axis in self._axes):
            self._moving_since = NEVER
        elif self._moving_since == NEVER:
            self._moving_since = now
        if now < self._overdue_at():
            self._speak_at = NEVER
            return ()
        if alarmed and now < self._speak_at:
            return ()
        self._speak_at = now + self._rules.cycle
        safe = self._all_safe()
        if alarmed:
            return safe
        titles = ", ".join(axis.rules.axis.title for axis in self._axes if now >= self._due(axis))
        return self._replaced(
            None, f"no set-point for {self._patience // MILLISECOND} ms: {titles}", safe, now
        )

    def _due(self, axis: GuardedAxis) -> Nanoseconds:
        """Return when the axis is overdue: so long after it was spoken for, or after the motion began."""
        return max(axis.spoken_at, self._moving_since) + self._patience

    def _overdue_at(self) -> Nanoseconds:
        """Return when the first axis is overdue."""
        return max(min([axis.spoken_at for axis in self._axes]), self._moving_since) + self._patience

    def _deadline(self) -> Nanoseconds:
        if self._speak_at != NEVER:
            return self._speak_at
        return min(NEVER, self._overdue_at())


def _ends_watch(payload: bytes) -> bool:
    return _writes(payload, CONSUMER_HEARTBEAT_1.index) and payload[4:] == bytes(4)


def _writes(payload: bytes, index: int) -> bool:
    return payload[0] & _SDO_DOWNLOAD == _SDO_DOWNLOAD and payload[1:3] == index.to_bytes(2, "little")
