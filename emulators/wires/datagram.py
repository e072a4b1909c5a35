"""A datagram link: delay, jitter and loss; packets may overtake one another, as they may on a network.

Chance comes from the generator that is passed in, and is drawn once for each packet. An impairment draws from
a generator of its own, so that it leaves the chance of the others as it is.
"""

from dataclasses import dataclass
from typing import TypeAlias

from numpy.random import Generator

from emulators.wires.ends import End, Observed
from emulators.world import World, WorldError, WorldNode
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, Nanoseconds

_Flight: TypeAlias = tuple[WorldNode, Packet]


@dataclass(frozen=True, slots=True)
class Impairment:
    """Impairment of packets from `begin` until `end`, beside the link's own delay, jitter and loss.

    `sender` names the sender of the packets concerned (None: every sender). It meets a `share` of them, which
    `generator` draws; a share of 1 draws nothing. One that is met is `lost`, or comes `late` by so much, or
    comes again after `again` (None: it does not).
    """

    sender: str | None = None
    begin: Nanoseconds = 0
    end: Nanoseconds = NEVER
    share: float = 1.0
    generator: Generator | None = None
    lost: bool = False
    late: Nanoseconds = 0
    again: Nanoseconds | None = None

    def meets(self, sender: str, now: Nanoseconds) -> bool:
        """Return whether it meets the packet that is sent now; drawn again at every call."""
        if self.sender not in (None, sender) or not self.begin <= now < self.end:
            return False
        return self.share >= 1.0 or self.generator is None or bool(self.generator.random() < self.share)


class DatagramWire(Observed):
    """Wire that carries each packet after `delay` plus up to `jitter`, or loses it by probability `loss`."""

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
        super().__init__(name)
        self.delay = delay
        self.jitter = jitter
        self.loss = loss
        self.sent = 0
        self.lost = 0
        self._generator = generator
        self._impairments: list[Impairment] = []

    def join(self, world: World, station: WorldNode, link: str) -> None:
        """Connect a station, which calls this wire `link`."""
        self._ends.join(End(station, link, world))

    def impair(self, what: Impairment) -> None:
        """Lose, delay or double packets from now on, as described."""
        self._impairments.append(what)

    def carry(self, sender: WorldNode, packet: Packet) -> None:
        """Send a packet on its way, or lose it."""
        self.sent += 1
        delay, generator = self.delay, self._generator
        if generator is not None:
            # The order of the draws is part of a run: loss first, and jitter only for what arrives.
            if self.loss and generator.random() < self.loss:
                self.lost += 1
                return
            if self.jitter:
                delay += int(generator.integers(0, self.jitter, endpoint=True))
        world = self._ends.world
        if self._impairments:
            self._carry_impaired(sender, packet, world.now + delay)
        else:
            world.call_at(world.now + delay, self._arrive, (sender, packet))

    def _carry_impaired(self, sender: WorldNode, packet: Packet, at: Nanoseconds) -> None:
        world = self._ends.world
        now = world.now
        self._impairments = [one for one in self._impairments if now < one.end]
        # Each draws, whatever the others have drawn: its own sequence stays the same.
        met = [one for one in self._impairments if one.meets(sender.name, now)]
        if any(one.lost for one in met):
            self.lost += 1
            return
        at += sum(one.late for one in met)
        world.call_at(at, self._arrive, (sender, packet))
        for one in met:
            if one.again is not None:
                world.call_at(at + one.again, self._arrive, (sender, packet))

    def _arrive(self, flight: _Flight) -> None:
        sender, packet = flight
        self._ends.hand_over(sender, packet)
