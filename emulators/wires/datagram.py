"""A datagram link: delay, jitter and loss; packets may overtake one another, as they may on a network.

Chance comes from the generator that is passed in, and is drawn once for each packet.
"""

from typing import TypeAlias

from numpy.random import Generator

from emulators.wires.ends import End, Ends, Observer
from emulators.world import Station, World, WorldError
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds

_Flight: TypeAlias = tuple[Station, Packet]


class DatagramWire:
    """Carries each packet after `delay` plus up to `jitter`, or loses it with probability `loss`."""

    def __init__(
        self,
        delay: Nanoseconds = 0,
        jitter: Nanoseconds = 0,
        loss: float = 0.0,
        generator: Generator | None = None,
        name: str = "operator",
    ) -> None:
        if delay < 0 or jitter < 0 or not 0.0 <= loss <= 1.0:
            raise WorldError(f"link '{name}': delay and jitter must not be negative, loss is from 0 to 1")
        if generator is None and (jitter or loss):
            raise WorldError(f"link '{name}': jitter and loss need a generator of random numbers")
        self.name = name
        self.delay = delay
        self.jitter = jitter
        self.loss = loss
        self.sent = 0
        self.lost = 0
        self._generator = generator
        self._ends = Ends(name)

    def join(self, world: World, station: Station, link: str) -> None:
        """Connect a station, which calls this wire `link`."""
        self._ends.join(End(station, link, world))

    def leave(self, station: Station) -> None:
        """Disconnect a station; its packets under way still arrive."""
        self._ends.leave(station)

    def observe(self, observer: Observer) -> None:
        """Call `observer` for every packet that arrives."""
        self._ends.observers.append(observer)

    def unobserved(self) -> None:
        """Let go of all observers."""
        self._ends.observers.clear()

    def carry(self, sender: Station, packet: Packet) -> None:
        """Send a packet on its way, or lose it."""
        self.sent += 1
        delay, generator = self.delay, self._generator
        if generator is not None:
            if self.loss and generator.random() < self.loss:
                self.lost += 1
                return
            if self.jitter:
                delay += int(generator.integers(0, self.jitter, endpoint=True))
        world = self._ends.world
        world.call_at(world.now + delay, self._arrive, (sender, packet))

    def _arrive(self, flight: _Flight) -> None:
        sender, packet = flight
        self._ends.hand_over(sender, packet)
