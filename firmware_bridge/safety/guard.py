"""The guard: the last look at everything that leaves for the drives; behind it is only the wire.

On CAN it looks at frames, on a serial line at commands; behind it a controller, or the line's end, adds check
sum and handshake. It shares no state with the interlocks and trusts nothing before it: what may leave stands
in `firmware_bridge.safety.guard_rules` and `guard_serial_rules`. A refusal puts the safe words in the place
of the refused ones, because a velocity drive that hears nothing keeps its last target. Operator datagrams
pass untouched. It sends no heartbeat: a bridge that hangs is also stopped by the drives' own watch.
"""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.node import OPERATOR, Node, Stoppable
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Link, Robot
from firmware_bridge.safety.guard_axis import GuardedAxis
from firmware_bridge.safety.guard_can import CanSpeech
from firmware_bridge.safety.guard_rules import Rules, rules_for
from firmware_bridge.safety.guard_serial import SerialSpeech
from firmware_bridge.safety.guard_serial_rules import SerialRules, serial_rules_for
from firmware_bridge.safety.guard_speech import Speech
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

SILENT_CYCLES: Final = 3
"""So many cycles without a set-point for an axis that was told to move, and the guard speaks itself."""
REMEMBERED: Final = 100
"""The newest refusals that are kept; all are counted."""


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

    def __init__(self, node: Node, rules: Rules | SerialRules, listener: Listener | None = None) -> None:
        self.node = node
        self.refused = 0
        """Refusals so far."""
        self._speech = _speech(rules)
        self._listener = listener
        self._refusals: deque[Refusal] = deque(maxlen=REMEMBERED)
        self._axes = self._speech.axes
        self._cycle: Final = self._speech.cycle
        self._patience: Final = SILENT_CYCLES * self._cycle
        self._moving_since: Nanoseconds = NEVER
        """Since when some axis has been told to move; NEVER while none is."""
        self._speak_at: Nanoseconds = NEVER
        """When the guard repeats itself while the bridge stays silent; NEVER while it does not."""
        self._deadline: Nanoseconds = NEVER
        """When the guard must look again, whatever happens."""
        self._stopping = False

    @property
    def refusals(self) -> tuple[Refusal, ...]:
        """The newest refusals, oldest first."""
        return tuple(self._refusals)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Pass a packet on, and judge what the node sends."""
        if packet.link == self._speech.link and not self._speech.passes(packet):
            return self.wake(now)
        return self._judged(self.node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node, judge what it sends, and speak for it when it is silent."""
        return self._judged(self.node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Pass the wish to end on, and judge what the node sends; a node that cannot stop is made safe."""
        self._stopping = True
        if not isinstance(self.node, Stoppable):
            return Reaction(self._sent(self._all_safe()))
        try:
            reaction = self.node.stop(now)
        except Exception as error:  # noqa: BLE001 - whatever broke the bridge, the drives must hear something
            reason = f"the bridge failed while stopping: {error!r}"
            return Reaction(self._sent(self._replaced(None, reason, self._all_safe(), now)))
        return self._judged(reaction, now)

    def _judged(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        sent: list[Packet] = []
        for packet in reaction.sent:
            if packet.link == OPERATOR:
                sent.append(packet)
            elif packet.link == self._speech.link:
                sent += self._admitted(packet, now)
            else:
                reason = f"link '{packet.link}' is not listed"
                sent += self._sent(self._replaced(packet, reason, self._all_safe(), now))
        if self._stopping and reaction.wake_at == NEVER:
            # It has ended in good order; whoever carries it takes NEVER for the end.
            return Reaction(tuple(sent))
        sent += self._sent(self._spoken_for(now))
        return Reaction(tuple(sent), min(reaction.wake_at, self._deadline))

    def _admitted(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return the frame itself, or what leaves in its place."""
        speech = self._speech
        if (axis := speech.axis_of(packet)) is not None:
            axis.spoken_at = now
        reason = speech.refuses(packet)
        if reason is None:
            speech.learn(packet)
            speech.leaves(packet, asked=True)
            return (packet,)
        safe = self._replaced(packet, reason, speech.in_place_of(packet), now)
        # The node goes on when its set-point is answered, whatever became of it; other words it misses.
        return self._sent(safe, asked=axis is not None)

    def _sent(self, packets: tuple[Packet, ...], *, asked: bool = False) -> tuple[Packet, ...]:
        for place, packet in enumerate(packets, 1):
            self._speech.leaves(packet, asked=asked and place == len(packets))
        return packets

    def _replaced(
        self, packet: Packet | None, reason: str, safe: tuple[Packet, ...], now: Nanoseconds
    ) -> tuple[Packet, ...]:
        for frame in safe:
            self._speech.learn(frame)
        refusal = Refusal(now, packet, reason, safe)
        self.refused += 1
        self._refusals.append(refusal)
        if self._listener is not None:
            self._listener(refusal)
        return safe

    def _all_safe(self) -> tuple[Packet, ...]:
        return tuple(safe for axis in self._axes if axis.powered for safe in self._speech.safe(axis))

    def _spoken_for(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return safe demands for all axes when some axis moves and some axis was forgotten for too long."""
        alarmed = self._speak_at != NEVER
        if not alarmed and not any(axis.under_way for axis in self._axes):
            self._moving_since = NEVER
        elif self._moving_since == NEVER:
            self._moving_since = now
        overdue_at = self._overdue_at()
        if now < overdue_at:
            self._speak_at = NEVER
            self._deadline = min(NEVER, overdue_at)
            return ()
        if alarmed and now < self._speak_at:
            return ()
        self._speak_at = self._deadline = now + self._cycle
        if alarmed and self._speech.speaking:
            return ()
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
        spoken_at = NEVER
        for axis in self._axes:
            spoken_at = min(spoken_at, axis.spoken_at)
        return max(spoken_at, self._moving_since) + self._patience


def _speech(rules: Rules | SerialRules) -> Speech:
    return CanSpeech(rules) if isinstance(rules, Rules) else SerialSpeech(rules)


def guarded(node: Node, robot: Robot, listener: Listener | None = None) -> Guarded:
    """Put a guard around a node, by the robot's list for the link that its file names."""
    return Guarded(node, _RULES[robot.bus.link](robot), listener)


_RULES: Final[Mapping[Link, Callable[[Robot], Rules | SerialRules]]] = {
    Link.CAN: rules_for,
    Link.SERIAL: serial_rules_for,
}
