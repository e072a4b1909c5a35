"""The output guard: a node around the bridge that judges its output, and sends for it when it is silent.

It shares neither state nor code with the interlocks and trusts nothing before it. One set of wire rules for
each link, by its protocol, lists the permitted packets; the rules over several axes, on whatever links, are
in `firmware_bridge.safety.guard.across_axes`. Behind it a controller, or a line's end, adds check sum and
handshake. A refusal puts safe commands in the place of the refused ones, because a drive that receives
nothing keeps its last target. Operator datagrams pass untouched. It sends no heartbeat: a bridge that hangs
is also stopped by the drives' own heartbeat consumers.
"""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Final, TypeAlias

from firmware_bridge.family import family_of
from firmware_bridge.node import OPERATOR, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard.across_axes import AxesRule, rules_across
from firmware_bridge.safety.guard.in_force import InForce
from firmware_bridge.safety.guard.wire_rules import WireRules
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

SILENT_CYCLES: Final = 3
"""So many cycles without a set-point for an axis while some axis moves, and the guard speaks itself."""
REMEMBERED: Final = 100
"""The newest refusals that are kept; all are counted."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """One packet that did not leave, or one silence that the guard filled."""

    at: Nanoseconds
    packet: Packet | None
    """None: nothing was refused, the bridge was silent, failed, or left something standing."""
    reason: str
    sent: tuple[Packet, ...]
    """The packets that left in its place."""


Listener: TypeAlias = Callable[[Refusal], None]


class Guarded:
    """A node behind the guard; itself a node that can be stopped."""

    def __init__(
        self,
        node: Node,
        links: Iterable[WireRules],
        across: tuple[AxesRule, ...],
        listener: Listener | None = None,
    ) -> None:
        self.node = node
        self.refused = 0
        """Refusals so far."""
        self.links: Final = {rules.link: rules for rules in links}
        self._listener = listener
        self._refusals: deque[Refusal] = deque(maxlen=REMEMBERED)
        self._axes = tuple(axis for rules in self.links.values() for axis in rules.axes)
        self._across = across
        self._across_of = {
            axis.axis.name: tuple(rule for rule in across if axis in rule.axes) for axis in self._axes
        }
        self._moving_since: Nanoseconds = NEVER
        """Since when some axis has been moving; NEVER while none is."""
        self._speak_at: Nanoseconds = NEVER
        """Time of the guard's next repetition while the bridge stays silent; NEVER while it is not."""
        self._deadline: Nanoseconds = NEVER
        """Time of the guard's next look, whatever happens."""
        self._due: Nanoseconds = NEVER
        """Time of the next look at a rule over several axes."""
        self._stopping = False
        self._unheard = False
        """True after the node failed in its stop: the next call stops it again."""
        self._failure: Exception | None = None
        """The node's failure, raised one call later: the guard's packets because of it leave first."""

    @property
    def refusals(self) -> tuple[Refusal, ...]:
        """The newest refusals, oldest first."""
        return tuple(self._refusals)

    @property
    def holding(self) -> bool:
        """True while the node keeps the robot from moving after a command to end."""
        return holds(self.node)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Forward a packet, and judge the node's output."""
        rules = self.links.get(packet.link)
        # The answer to a command of the guard itself would be taken for that to an open request of the
        # bridge.
        if rules is not None and not rules.receives(packet, now):
            return self.wake(now)
        return self._judged(self._tried(partial(self.node.receive, packet), now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node, judge what it sends, and speak for it when it is silent."""
        if self._unheard:
            return self.stop(now)
        return self._judged(self._tried(self.node.wake, now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Forward the command to end, and judge the output; a node that cannot stop is made safe."""
        self._stopping = True
        if not isinstance(self.node, Stoppable):
            return Reaction(self._sent(self._all_safe(), now))
        reaction = self._tried(self.node.stop, now)
        self._unheard = self._failure is not None
        if self._unheard:
            reason = f"the bridge failed while stopping: {self._failure!r}"
            return Reaction(self._replaced(None, reason, self._all_safe(), now), now)
        return self._judged(reaction, now)

    def _tried(self, call: Callable[[Nanoseconds], Reaction], now: Nanoseconds) -> Reaction:
        """Return the node's reaction; a failed node counts as silent, and the guard sends in its place."""
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure
        try:
            return call(now)
        except Exception as error:  # noqa: BLE001 - whatever failed in the bridge, the devices need a command
            self._failure = error
            return Reaction((), now)

    def _judged(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        sent: list[Packet] = []
        for packet in reaction.sent:
            if packet.link == OPERATOR:
                sent.append(packet)
                continue
            rules = self.links.get(packet.link)
            if rules is None:
                reason = f"link '{packet.link}' is not listed"
                sent += self._replaced(packet, reason, self._all_safe(), now)
            else:
                sent += self._admitted(packet, rules, now)
        if self._stopping and not self._unheard and reaction.wake_at == NEVER:
            # It has ended in good order; its carrier takes NEVER for the end.
            return Reaction(tuple(sent))
        sent += self._cleared(now)
        sent += self._spoken_for(now)
        again = now if self._unheard else NEVER
        return Reaction(tuple(sent), min(reaction.wake_at, self._deadline, self._due, again))

    def _admitted(self, packet: Packet, rules: WireRules, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return the packet itself, or what leaves in its place."""
        axes = rules.axes_of(packet)
        reason = rules.refuses(packet, now)
        if not axes:
            if reason is None:
                return self._sent((packet,), now, requested=packet)
            replacement = rules.replacement_of(packet)
            return self._replaced(
                packet, reason, self._all_safe() if replacement is None else replacement, now
            )
        # A refused set-point, too, shows that the bridge is alive: its silence is judged apart from its
        # errors.
        for axis in axes:
            axis.commanded_at = now
        others: tuple[InForce, ...] = ()
        if reason is None:
            requested = rules.requested_by(packet)
            for rule in self._across_all(axes):
                reason = rule.refuses(requested, now)
                if reason is not None:
                    others = rule.stops_with(axes)
                    break
            else:
                return self._sent((packet,), now, requested=packet)
        # The refused axis comes last: its safe command takes the place of the refused one for the node.
        safe = self._joined((*others, *axes))
        # The node goes on when its set-point is answered, by whatever answer; other commands it misses.
        return self._replaced(packet, reason, safe, now, requested=safe[-1])

    def _sent(
        self, packets: tuple[Packet, ...], now: Nanoseconds, requested: Packet | None = None
    ) -> tuple[Packet, ...]:
        """Note what leaves; to `requested`, which is one of them, the node waits for an answer."""
        for packet in packets:
            axes = self.links[packet.link].sends(packet, now, requested=packet is requested)
            for axis in axes:
                for rule in self._across_of[axis.axis.name]:
                    rule.sent(axis, now)
        return packets

    def _replaced(
        self,
        packet: Packet | None,
        reason: str,
        safe: tuple[Packet, ...],
        now: Nanoseconds,
        requested: Packet | None = None,
    ) -> tuple[Packet, ...]:
        refusal = Refusal(now, packet, reason, safe)
        self.refused += 1
        self._refusals.append(refusal)
        if self._listener is not None:
            self._listener(refusal)
        return self._sent(safe, now, requested)

    def _across_all(self, axes: tuple[InForce, ...]) -> tuple[AxesRule, ...]:
        """Return the rules over any of these axes, each once."""
        return tuple([rule for rule in self._across if not rule.members.isdisjoint(axes)])

    def _joined(self, axes: Iterable[InForce]) -> tuple[Packet, ...]:
        """Return the safe commands of these axes, each once, also where one serves several of them."""
        return tuple(dict.fromkeys(safe for axis in axes for safe in self.links[axis.axis.link].safe(axis)))

    def _all_safe(self, *, received: bool = False) -> tuple[Packet, ...]:
        """Return the safe commands of every axis with power; `received`: on links where none of them wait."""
        return self._joined(
            axis
            for rules in self.links.values()
            if not (received and rules.waiting)
            for axis in rules.axes
            if axis.powered
        )

    def _cleared(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Stop the axes of each rule that no one has fixed in time, and find out which one is the next."""
        sent: tuple[Packet, ...] = ()
        for rule in self._across:
            if rule.due <= now:
                safe = self._joined(axis for axis in rule.axes if axis.moving)
                sent += self._replaced(None, f"{rule.name} stayed beyond its bound", safe, now)
        # Only now: the safe commands above have set new deadlines.
        self._due = NEVER
        for rule in self._across:
            self._due = min(self._due, rule.due)
        return sent

    def _spoken_for(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return safe set-points for all axes when one moves and one was forgotten for too long."""
        alarmed = self._speak_at != NEVER
        if not alarmed and not any(axis.moving for axis in self._axes):
            self._moving_since = self._deadline = NEVER
            return ()
        # An axis at standstill needs no set-point; its silence counts from the first motion on.
        if self._moving_since == NEVER:
            self._moving_since = now
        overdue_at = self._overdue_at(self._axes)
        if now < overdue_at:
            self._speak_at = NEVER
            self._deadline = overdue_at
            return ()
        if alarmed and now < self._speak_at:
            return ()
        self._speak_at = self._deadline = now + min(axis.cycle for axis in self._axes)
        # Repeated each cycle on links that are free: on a busy line the copies would only queue up.
        if alarmed:
            return self._sent(self._all_safe(received=True), now)
        silent = [axis for axis in self._axes if now >= self._overdue_at((axis,))]
        patience = SILENT_CYCLES * min(axis.cycle for axis in silent) // MILLISECOND
        titles = ", ".join(axis.axis.title for axis in silent)
        return self._replaced(None, f"no set-point for {patience} ms: {titles}", self._all_safe(), now)

    def _overdue_at(self, axes: tuple[InForce, ...]) -> Nanoseconds:
        """Return when the first of the axes is overdue: so long after its set-point, or its motion's begin.

        One that finds its zero is sent none; the bridge shows by the others that it lives.
        """
        since, first = self._moving_since, NEVER
        for axis in axes:
            if not axis.homes:
                first = min(first, max(axis.commanded_at, since) + SILENT_CYCLES * axis.cycle)
        return first


def guarded(node: Node, robot: AnyRobot, listener: Listener | None = None) -> Guarded:
    """Put a guard around a node, with the rules of every link that the robot's file names."""
    links = [family_of(table).wire_rules(robot, link) for link, table in robot.links.items()]
    axes = {axis.axis.name: axis for rules in links for axis in rules.axes}
    # Set when all links are known: a homing on one of them forbids motion on the others.
    for axis in axes.values():
        axis.all = tuple(axes.values())
    return Guarded(node, links, rules_across(robot, axes), listener)
