"""The virtual world: one thread, one integer clock, nodes on wires, and the physics between two events.

It is independent of the kinds of nodes and wires, and it never reads a real clock. Events at the same instant
happen in the order in which they were requested, so two runs are the same byte for byte.
"""

from bisect import insort
from collections.abc import Callable, Mapping
from typing import Any, Final, Protocol

from emulators.rewind import Checkpoint, External, Rewind
from emulators.trace import Trace, trace_line
from firmware_bridge.node import Node, Selective, Stoppable
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds

LIVELOCK: Final = 100_000
"""Limit of events at one instant; more are a fault of a node that requests a wake at once, for ever."""


MOST_KEPT: Final = 256
"""Packets that wait for a node that is suspended; assumed: 212,992 bytes of a socket of Linux, 832 each."""


class WorldError(Exception):
    """A world that is wired wrongly, or a node that lets no time pass."""


class Physics(Protocol):
    """Physics between two events: servo loops and the plant."""

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move on to `until`, or to the first event before it; return the instant and the nodes to wake then.

        With no one to wake, everything up to `until` has been done. Each event is reported once.
        """


class _Stillness:
    """The physics of a world in which nothing moves."""

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Return `until`: nothing moves before it."""
        return until, ()


class Wire(Protocol):
    """Wire that carries packets between the stations on it, in its own time."""

    name: str

    def join(self, world: "World", station: "WorldNode", link: str) -> None:
        """Connect a station, which calls this wire `link`."""

    def leave(self, station: "WorldNode") -> None:
        """Disconnect a station; what it has not wholly sent is lost."""

    def carry(self, sender: "WorldNode", packet: Packet) -> None:
        """Take a packet for transmission from now on."""


class WorldNode:
    """A node at its place in the world."""

    __slots__ = ("kept", "links", "listens", "name", "node", "receive", "silent_from", "wake", "wake_at")

    def __init__(self, name: str, node: Node, links: Mapping[str, Wire]) -> None:
        self.name = name
        self.node = node
        self.links = dict(links)
        self.receive = node.receive
        self.wake = node.wake
        self.listens = node.listens if isinstance(node, Selective) else None
        self.wake_at: Nanoseconds = NEVER
        self.silent_from: Nanoseconds = NEVER
        self.kept: list[Packet] | None = None
        """Packets that wait for a node that is suspended; None for one that runs."""


class World:
    """Nodes, wires and physics in virtual time. Times in nanoseconds from the start of the run."""

    def __init__(self, physics: Physics | None = None) -> None:
        self.now: Nanoseconds = 0
        self.events = 0
        self._physics: Physics = _Stillness() if physics is None else physics
        self._moved_to: Nanoseconds = -1
        self._crowd = 0
        self._stations: dict[str, WorldNode] = {}
        self._gone: dict[str, Nanoseconds] = {}
        self._agenda: list[tuple[Nanoseconds, int, Callable[[Any], None], Any]] = []
        """Scheduled events, in order. The list is short, and so takes less comparing than a heap."""
        self._sequence = 0
        self._trace = Trace()
        self._traces: dict[str, Trace] = {}
        """Traces of each wire alone, by its name."""
        self._observers: External[Callable[[bytes], None]] = External()
        self._rewind = Rewind(self)

    def attach(self, name: str, node: Node, links: Mapping[str, Wire]) -> WorldNode:
        """Put a node on its wires, by the names that it has for them; it is first woken now."""
        if name in self._stations:
            raise WorldError(f"there is a node '{name}' already")
        station = WorldNode(name, node, links)
        for link, wire in station.links.items():
            wire.join(self, station, link)
        self._stations[name] = station
        self._gone.pop(name, None)
        self._command(station, self.now)
        return station

    def detach(self, name: str) -> None:
        """Remove a node for good, now: it neither receives, nor sends, nor is woken."""
        station = self._station(name)
        del self._stations[name]
        # The physics may still report an event for it, which is no error then.
        self._gone[name] = self.now
        station.wake_at = NEVER
        station.silent_from = self.now
        for wire in station.links.values():
            wire.leave(station)

    def here(self, name: str) -> bool:
        """Return whether a node of this name is on its wires."""
        return name in self._stations

    def links(self, name: str) -> Mapping[str, Wire]:
        """Return the wires of a node, by the names that it has for them."""
        return dict(self._station(name).links)

    def silence(self, name: str, from_time: Nanoseconds) -> None:
        """Cut a node off its wires from an instant on. It lives on and may notice; `NEVER` restores it."""
        self._station(name).silent_from = from_time

    def suspend(self, name: str) -> None:
        """Let a node's program not run, like a stopped process or a machine asleep; packets wait for it."""
        station = self._station(name)
        station.kept = [] if station.kept is None else station.kept

    def resume(self, name: str) -> None:
        """Let it run again: what has waited is received now, in order, and then it is woken."""
        station = self._station(name)
        kept, station.kept = station.kept, None
        for packet in kept or ():
            self.deliver(station, packet)
        self._command(station, self.now)

    def rouse(self, name: str) -> None:
        """Wake a node now: something was done to it that it has to act on."""
        self._command(self._station(name), self.now)

    def stop(self, name: str) -> None:
        """Request a node to end in good order, now, as the real-time runner does on Ctrl-C."""
        station = self._station(name)
        if not isinstance(station.node, Stoppable):
            raise WorldError(f"node '{name}' cannot be stopped in order")
        self._take(station, station.node.stop(self.now))

    def run(self, until: Nanoseconds) -> None:
        """Let everything happen up to and including `until`; WorldError where time stands still."""
        if until < self.now:
            raise WorldError(f"cannot run back from {self.now} ns to {until} ns")
        agenda = self._agenda
        while True:
            due = agenda[0][0] if agenda else NEVER
            at = min(until, due)
            # Physics first: it may stop before the next event,
            # and nodes that it wakes may schedule earlier ones.
            if at > self._moved_to:
                reached, names = self._physics.advance(at)
                if names:
                    self._wake_all(names, reached)
                    continue
                # No event up to here: for further events at this instant the physics is not called again.
                self._moved_to = at
            if due > until:
                break
            if at == self.now:
                self._crowded()
            else:
                self.now = at
                self._crowd = 0
            _, _, call, argument = agenda.pop(0)
            call(argument)
            self.events += 1
        self.now = until

    def snapshot(self) -> Checkpoint:
        """Keep this instant, whole: clock, wires, nodes, physics, chance, trace. Between two calls of `run`.

        What is outside is not kept: observers, and what they write. RewindError where someone has a state
        that cannot be kept; PlantError where a plant cannot.
        """
        return self._rewind.snapshot()

    def restore(self, checkpoint: Checkpoint) -> None:
        """Go to an instant that this world has kept, earlier or later; the run goes on as it went then."""
        self._rewind.restore(checkpoint)

    def call_at(self, at: Nanoseconds, call: Callable[[Any], None], argument: object = None) -> None:
        """Call a wire back at an instant that is not in the past."""
        # Keeps the order of the requests at one instant; callables themselves cannot be compared.
        self._sequence = sequence = self._sequence + 1
        insort(self._agenda, (at, sequence, call, argument))

    def deliver(self, station: WorldNode, packet: Packet) -> None:
        """Hand a packet to a station that listens to it, now, and take what it sends in answer."""
        now = self.now
        if station.kept is not None:
            # Beyond its buffer the newest are lost, as a socket's of Linux are.
            if len(station.kept) < MOST_KEPT:
                station.kept.append(packet)
        elif now < station.silent_from:
            # A node that is cut off neither receives nor answers; it is still woken, and may notice.
            reaction = station.receive(packet, now)
            if reaction.sent or reaction.wake_at != station.wake_at:
                self._take(station, reaction)

    def observe(self, observer: Callable[[bytes], None]) -> None:
        """Call `observer` with each line of the trace; see `emulators.trace`."""
        self._observers.append(observer)

    def note(self, wire: str, sender: str, packet: Packet) -> None:
        """Add one carried packet to the trace."""
        line = trace_line(self.now, wire, sender, packet)
        self._trace.add(line)
        own = self._traces.get(wire)
        if own is None:
            own = self._traces[wire] = Trace()
        own.add(line)
        for observer in self._observers:
            observer(line)

    @property
    def trace_sha256(self) -> str:
        """The SHA-256 of the trace so far: every packet carried, in order."""
        return self._trace.sha256

    @property
    def links_sha256(self) -> dict[str, str]:
        """The SHA-256 of each wire's own lines of the trace, by the wire's name; none before its first."""
        return {wire: trace.sha256 for wire, trace in sorted(self._traces.items())}

    def _station(self, name: str) -> WorldNode:
        if name not in self._stations:
            raise WorldError(f"there is no node '{name}'; there are: {', '.join(self._stations) or 'none'}")
        return self._stations[name]

    def _crowded(self) -> None:
        """Count one more event at this instant."""
        self._crowd += 1
        if self._crowd > LIVELOCK:
            raise WorldError(
                f"time stands still at {self.now} ns: a node or the physics wants to be woken for ever"
            )

    def _wake_all(self, names: tuple[str, ...], reached: Nanoseconds) -> None:
        """Wake those for whom the physics has stopped on its way."""
        if reached == self.now:
            self._crowded()
        else:
            self.now = reached
            self._crowd = 0
        for name in names:
            station = self._stations.get(name)
            if station is not None:
                self._take(station, station.wake(reached))
            elif name not in self._gone:
                raise WorldError(f"the physics wakes '{name}', and there is no such node")

    def _take(self, station: WorldNode, reaction: Reaction) -> None:
        if reaction.sent and self.now < station.silent_from:
            for packet in reaction.sent:
                wire = station.links.get(packet.link)
                if wire is None:
                    raise WorldError(f"node '{station.name}' sends on '{packet.link}', where it has no wire")
                wire.carry(station, packet)
        if reaction.wake_at != station.wake_at:
            self._command(station, reaction.wake_at)

    def _command(self, station: WorldNode, wake_at: Nanoseconds) -> None:
        at = max(wake_at, self.now)
        station.wake_at = at
        if at != NEVER:
            self.call_at(at, self._wake, station)

    def _wake(self, station: WorldNode) -> None:
        # An earlier request stays on the agenda: it finds another time here, and does nothing.
        if station.wake_at == self.now and station.kept is None:
            station.wake_at = NEVER
            self._take(station, station.wake(self.now))
