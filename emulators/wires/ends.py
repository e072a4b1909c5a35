"""Common parts of all wires: the stations at their ends, the observers, and the trace of the traffic."""

from collections.abc import Callable
from typing import TypeAlias

from emulators.rewind import External
from emulators.world import World, WorldError, WorldNode
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds

Observer: TypeAlias = Callable[[Nanoseconds, str, Packet], None]
"""Callback with the instant, the sender's name and the packet, when the packet has wholly arrived."""


class End:
    """A station at the end of a wire, which it calls `link`."""

    __slots__ = ("link", "station", "world")

    def __init__(self, station: WorldNode, link: str, world: World) -> None:
        self.station = station
        self.link = link
        self.world = world


class Ends:
    """Stations at the ends of one wire, in the order in which they joined; each receives from all others."""

    def __init__(self, wire: str) -> None:
        self.wire = wire
        self.all: list[End] = []
        self.observers: External[Observer] = External()
        self.not_receiving: frozenset[WorldNode] = frozenset()
        """Stations that the packet in hand does not reach."""
        self._world: World | None = None

    @property
    def world(self) -> World:
        """The world that this wire is in; WorldError before anybody has joined."""
        if self._world is None:
            raise WorldError(f"no one is on wire '{self.wire}' yet")
        return self._world

    def join(self, end: End) -> None:
        """Add an end; WorldError where the others are in another world."""
        if self._world is not None and self._world is not end.world:
            raise WorldError(f"wire '{self.wire}' is in another world already")
        self._world = end.world
        self.all.append(end)

    def leave(self, station: WorldNode) -> None:
        """Remove the end of a station."""
        self.all = [end for end in self.all if end.station is not station]

    def hand_over(self, sender: WorldNode, packet: Packet) -> None:
        """Give a packet that has wholly arrived to observers, trace and all but its sender."""
        world, not_receiving, sent_on = self.world, self.not_receiving, packet.link
        # Before any station reacts: an answer comes behind its cause in trace and recordings.
        for observer in self.observers:
            observer(world.now, sender.name, packet)
        world.note(self.wire, sender.name, packet)
        for end in self.all:
            station, link = end.station, end.link
            if station is sender or (not_receiving and station in not_receiving):
                continue
            # Each station has its own name for the wire.
            received = packet if link == sent_on else Packet(link, packet.address, packet.payload)
            listens = station.listens
            if listens is None or listens(received):
                world.deliver(station, received)


class Observed:
    """Common base of the wires: they have a name and ends, and report their traffic to observers."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._ends = Ends(name)

    def leave(self, station: WorldNode) -> None:
        """Disconnect a station."""
        self._ends.leave(station)

    def observe(self, observer: Observer) -> None:
        """Call `observer` for every packet that has wholly arrived."""
        self._ends.observers.append(observer)

    def unobserved(self) -> None:
        """Let go of all observers."""
        self._ends.observers.clear()
