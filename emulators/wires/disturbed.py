"""A CAN bus with disturbances: damaged frames are sent again, controllers grow passive, fall off, return.

Source: ISO 11898-1. Simplified: a damage is noticed when the frame ends; a passive sender does not wait eight
bits more than the others; a controller returns after the least time, 128 x 11 bits.
"""

from collections import deque
from dataclasses import dataclass
from typing import Final

from emulators.wires.can import CanWire, Controller
from emulators.wires.confinement import RECOVERY_BITS, Condition, Confinement
from emulators.world import Station, World, WorldError
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.can import INTERFRAME_BITS
from firmware_bridge.wire.can_error import (
    ACTIVE_AGAIN,
    BUS_OFF,
    CONTROLLER,
    RECEIVE_OVERFLOW,
    RECEIVE_PASSIVE,
    RESTARTED,
    TRANSMIT_OVERFLOW,
    TRANSMIT_PASSIVE,
    Loss,
    encode_report,
)

UNSENT_BITS: Final = 7
"""The end of frame, which a damaged frame does not come to."""
FLAG_BITS: Final = 6 + 8
"""Error flag and error delimiter."""


@dataclass(frozen=True, slots=True)
class Disturbance:
    """Damage to frames from `begin` until `end`, at most `count` of them.

    `sender` names whose frames (None: everybody's); `receiver` names the only station that sees them wrongly,
    as with a bad plug there (None: everybody does).
    """

    sender: str | None = None
    receiver: str | None = None
    begin: Nanoseconds = 0
    end: Nanoseconds = NEVER
    count: int | None = None


class _Standing:
    __slots__ = ("left", "what")

    def __init__(self, what: Disturbance) -> None:
        self.what = what
        self.left = what.count

    def hits(self, sender: str, now: Nanoseconds) -> bool:
        what = self.what
        return what.sender in (None, sender) and what.begin <= now < what.end and self.left != 0


class DisturbedCanWire(CanWire):
    """A CAN bus on which frames can be damaged, and controllers overrun."""

    def __init__(self, bit_rate: int, name: str = "can", depth: int | None = None) -> None:
        """`depth` is how many frames a station's transmit queue holds; None: any number."""
        super().__init__(bit_rate, name)
        self.damaged = 0
        self._depth = depth
        self._standing: list[_Standing] = []
        self._counters: dict[Station, Confinement] = {}
        self._parked: dict[Station, deque[Packet]] = {}
        self._full: set[Station] = set()

    def disturb(self, what: Disturbance) -> None:
        """Damage frames from now on, as described."""
        self._standing.append(_Standing(what))

    def calm(self) -> None:
        """End all disturbances."""
        self._standing.clear()

    def overrun(self, name: str, loss: Loss = Loss.UNKNOWN) -> None:
        """Have a station's controller report that it has lost a frame; what was lost is not told."""
        self._report(self._named(name), CONTROLLER, RECEIVE_OVERFLOW, loss)

    def confinement(self, name: str) -> Confinement:
        """Return a station's error counters; WorldError where there is none of this name."""
        return self._counters[self._named(name)]

    def join(self, world: World, station: Station, link: str) -> None:
        """Connect a station, which calls this wire `link`."""
        super().join(world, station, link)
        self._counters[station] = Confinement()

    def leave(self, station: Station) -> None:
        """Disconnect a station."""
        super().leave(station)
        del self._counters[station]
        self._parked.pop(station, None)
        self._full.discard(station)

    def carry(self, sender: Station, packet: Packet) -> None:
        """Queue a frame; a station that is off the bus sends it after its return."""
        parked = self._parked.get(sender)
        waiting = self._controllers[sender].queue if parked is None else parked
        if self._depth is not None and len(waiting) >= self._depth:
            if sender not in self._full:  # told once, until there is room again
                self._full.add(sender)
                self._report(sender, CONTROLLER, TRANSMIT_OVERFLOW, Loss.QUEUE)
        elif parked is None:
            super().carry(sender, packet)
        else:
            parked.append(packet)

    # Frames

    def _fault(self, sender: Station) -> _Standing | None:
        """Return the disturbance that meets a frame which ends now."""
        now = self._ends.world.now
        for standing in self._standing:
            if standing.hits(sender.name, now) and standing.what.receiver != sender.name:
                standing.left = None if standing.left is None else standing.left - 1
                return standing
        return None

    def _spoilt(self, fault: _Standing | None) -> tuple[Station | None, bool]:
        """Return who alone sees a frame wrongly, if that is so, and whether its flag damages it for all."""
        if fault is None:
            return None, False
        if fault.what.receiver is None:
            return None, True
        receiver = self._named(fault.what.receiver)
        # The flag of a passive controller is recessive: it spoils the frame for itself only.
        return receiver, self._counters[receiver].condition is Condition.ACTIVE

    def _finish(self, controller: Controller) -> None:
        sender = controller.station
        world = self._ends.world
        if world.now >= sender.silent_from or sender not in self._counters:
            super()._finish(controller)
            return
        wrong, damaged = self._spoilt(self._fault(sender))
        if damaged:
            self._damage(controller, wrong)
            return
        off = tuple(self._parked)
        self._ends.deaf = frozenset(off if wrong is None else (*off, wrong))
        super()._finish(controller)
        self._ends.deaf = frozenset()
        self._full.discard(sender)
        self._tell(sender, changed=self._counters[sender].sent())
        for station, counters in tuple(self._counters.items()):
            if station is not sender and station not in off:
                missed = station is wrong
                self._tell(
                    station, changed=counters.failed_to_hear(first=True) if missed else counters.heard()
                )

    def _damage(self, controller: Controller, first: Station | None) -> None:
        """End a frame with an error flag: everybody counts, and it waits to be sent again."""
        world, sender = self._ends.world, controller.station
        bits = controller.queue[0][1]
        self.damaged += 1
        taken = (FLAG_BITS - UNSENT_BITS + INTERFRAME_BITS) * self.bit_time
        self._idle_from = world.now + taken
        self._measure(world.now, bits * self.bit_time + taken)
        for station, counters in tuple(self._counters.items()):
            if station is sender:
                self._tell(station, changed=counters.failed_to_send())
            elif station not in self._parked:
                self._tell(station, changed=counters.failed_to_hear(first=station is first))
        self._go_on()

    # Controllers

    def _tell(self, station: Station, *, changed: bool) -> None:
        if not changed:
            return
        counters = self._counters[station]
        if counters.condition is Condition.OFF:
            self._controllers[station].queue.clear()
            self._parked[station] = deque()
            world = self._ends.world
            world.call_at(world.now + RECOVERY_BITS * self.bit_time, self._return, station)
            self._report(station, BUS_OFF)
        elif counters.condition is Condition.PASSIVE:
            receiving = counters.receive > counters.transmit
            self._report(station, CONTROLLER, RECEIVE_PASSIVE if receiving else TRANSMIT_PASSIVE)
        else:
            self._report(station, CONTROLLER, ACTIVE_AGAIN)

    def _return(self, station: Station) -> None:
        parked = self._parked.pop(station, None)
        if parked is None or station not in self._counters:
            return
        self._counters[station].recover()
        self._report(station, RESTARTED)
        for packet in parked:
            super().carry(station, packet)

    def _report(self, station: Station, address: int, state: int = 0, loss: Loss = Loss.UNKNOWN) -> None:
        counters = self._counters[station]
        payload = encode_report(state, loss, counters.transmit, counters.receive)
        link = self._controllers[station].link
        self._ends.world.deliver(station, Packet(link, address, payload))

    def _named(self, name: str) -> Station:
        for station in self._counters:
            if station.name == name:
                return station
        raise WorldError(f"there is no node '{name}' on wire '{self.name}'")
