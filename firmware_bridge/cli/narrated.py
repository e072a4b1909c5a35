"""Display of a bridge's changes for the user, and the storage of its axes' positions."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final, TypeAlias

from firmware_bridge.bridge import Bridge, Life
from firmware_bridge.cli.leaving import Leaving
from firmware_bridge.cli.remembered import Remembered
from firmware_bridge.node import Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.runtime.last_places import LastPlaces
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.units import SECOND, Nanoseconds, to_seconds

Say: TypeAlias = Callable[[str], None]


class StartUpFailedError(Exception):
    """The robot's drives could not be set up: which one, what was expected, what came."""


class Narrated:
    """A bridge whose phases, interlock events and motion permission are reported as they change.

    It ends the run when the start-up has failed. `node` is what is carried: the bridge, or a node around it.
    """

    def __init__(
        self,
        bridge: Bridge,
        node: Node,
        machine: AnyRobot,
        say: Say,
        *,
        kept: LastPlaces,
        stamps: Remembered,
        hints: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self._bridge = bridge
        self._links: Final = frozenset(hints)
        self._hints = dict(hints)
        """Possible faults of a link without any traffic yet, by its name."""
        self._stamps: Final = stamps
        self._kept: Final = kept
        self._keeping_failed = False
        self._node = node
        self._print = say
        self._phase: Life | None = None
        self._armed = False
        self._late = 0
        self._late_reported_at: Nanoseconds = 0
        self._shown: tuple[ActiveInterlock, ...] = ()
        self._failure: Exception | None = None
        self._silent = False
        self._leaving: Final = Leaving(machine, self._say)

    @property
    def unattended(self) -> str:
        """The robot's state if it is carried no further."""
        return self._leaving.unattended

    def may_leave(self, now: Nanoseconds) -> bool:
        """Take one more request to end while it ends; return whether it is carried no further."""
        return self._leaving.may_leave(now)

    @property
    def holding(self) -> bool:
        """True while the node keeps the robot from moving after a command to end."""
        return holds(self._node)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Forward the packet, and report the changes."""
        # An empty packet is news of the line itself, and no sign of a device.
        if packet.payload:
            self._hints.pop(packet.link, None)
        self._raise_failure()
        return self._after(self._node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the bridge, and report the changes."""
        self._raise_failure()
        return self._after(self._node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the bridge, and report the changes."""
        reaction = self._node.stop(now) if isinstance(self._node, Stoppable) else Reaction()
        return self._after(reaction, now)

    def _raise_failure(self) -> None:
        """End the run one call after a failure, so that what the bridge sent because of it has left."""
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure
        bridge = self._bridge
        if bridge.failure is not None and bridge.phase is Life.FAILED:
            hints = list(self._hints.values())
            # Without any traffic the hints are all there is to report.
            texts = hints if self._alone else [bridge.failure, *hints]
            raise StartUpFailedError(f"start-up failed: {'; '.join(texts)}")

    @property
    def _alone(self) -> bool:
        """True where no packet was received on any link."""
        return bool(self._links) and self._hints.keys() == self._links

    def _after(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        """Report what has changed; a failure of that is raised one call later: what is sent leaves."""
        if self._silent:
            return reaction
        try:
            self._show_changes(now)
        except Exception as failure:  # noqa: BLE001 - it is raised, and nothing is reported any more
            self._silent, self._failure = True, failure
            # What the bridge sends leaves first: no output may hold up a stop.
            return Reaction(reaction.sent, min(reaction.wake_at, now))
        return reaction

    def _show_changes(self, now: Nanoseconds) -> None:
        bridge = self._bridge
        if bridge.phase is not self._phase:
            self._phase = bridge.phase
            self._say(self._phase.value, now)
            for remark in bridge.all_drivers.remarks if self._phase is Life.RUNNING else ():
                self._say(remark, now)
            if self._phase is Life.FINISHED and bridge.not_acknowledged and not self._alone:
                self._say(not_confirmed(bridge), now)
        self._keep(now)
        problem = self._stamps.keep(bridge.operator.stamps, now, ended=bridge.finished)
        if problem is not None:
            self._say(problem, now)
        self._show_operators(now)
        late = bridge.all_drivers.late
        # Once a second at most: on a machine that is too slow each report costs time, too.
        if late != self._late and now - self._late_reported_at >= SECOND:
            self._say(f"late: {late - self._late} cycles were longer than the robot file allows", now)
            self._late, self._late_reported_at = late, now
        # A failure is reported at the end, and phases are not worth a report without a reader.
        ends = bridge.phase not in (Life.STARTING, Life.RUNNING)
        if (
            bridge.interlock_events != self._shown
            and bridge.phase is not Life.FAILED
            and not (ends and self._alone)
        ):
            self._show_interlocks({event.name: event for event in bridge.interlock_events}, now)
            self._shown = bridge.interlock_events

    def _show_operators(self, now: Nanoseconds) -> None:
        """Return whether it is armed, and the untrusted senders."""
        bridge = self._bridge
        if bridge.seen.facts.armed != self._armed:
            self._armed = bridge.seen.facts.armed
            self._say("armed" if self._armed else "disarmed", now)
        for text in bridge.operator.take_new_stations():
            self._say(text, now)

    def _keep(self, now: Nanoseconds) -> None:
        """Keep where the axes stand; a file that cannot be written ends no run."""
        self._kept.keep(self._bridge.places, now)
        problem = self._kept.file.problem(now)
        if problem is not None and not self._keeping_failed:
            self._keeping_failed = True
            self._say(f"where the axes stand is not kept: {problem}", now)

    def _show_interlocks(self, standing: Mapping[str, ActiveInterlock], now: Nanoseconds) -> None:
        known = {event.name: event.reason for event in self._shown}
        for name in known:
            if name not in standing:
                self._say(f"cleared: {name}", now)
        for name, event in standing.items():
            if known.get(name) != event.reason:
                self._say(f"active: {name}: {event.reason} ({event.remedy})", now)

    def _say(self, text: str, now: Nanoseconds) -> None:
        self._print(f"{to_seconds(now):9.3f} s  {text}")


def not_confirmed(bridge: Bridge) -> str:
    """Say whose power is not known to be off, if any's; switching the battery off is what is left."""
    names = ", ".join(bridge.not_acknowledged)
    return f"not confirmed to be without power: {names}; switch the battery off" if names else ""
