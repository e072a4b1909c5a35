"""A CAN bus with faults: damaged and lost frames, cut and swapped cables, controllers that leave the bus.

While nothing is wrong it is as any other bus. Source: ISO 11898-1. Simplified: a damage is noticed when the
frame ends; a passive sender does not wait eight bits more than the others; a controller returns after the
least time, 128 x 11 bits; the two halves of a cut cable still take turns; a frame that no one acknowledges is
repeated until its sender is passive, and then waits, in a queue of `WAITING`, until someone is there.
"""

from collections import deque
from collections.abc import Collection
from typing import Final

from emulators.wires.can import CanWire, Controller
from emulators.wires.confinement import RECOVERY_BITS, Condition, Confinement
from emulators.wires.disturbance import Disturbance, Effect, Standing
from emulators.world import World, WorldError, WorldNode
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds
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
WAITING: Final = 10
"""Frames that wait while a station cannot send; further ones are dropped (Linux' default queue, txqueuelen;
assumed for a drive)."""


class FaultyCanWire(CanWire):
    """A CAN bus on which frames can be damaged and lost, cables cut and swapped, and controllers overrun."""

    def __init__(self, bit_rate: int, name: str = "can", depth: int | None = None) -> None:
        """`depth` is how many frames a station's transmit queue holds; None: any number."""
        super().__init__(bit_rate, name)
        self.damaged = 0
        self.lost = 0
        """Frames that were lost before the bus, and those dropped because a queue was full."""
        self._depth = depth
        self._sound = depth is None
        """True if nothing is wrong, and no counter remembers that anything was."""
        self._standing: list[Standing] = []
        self._counters: dict[WorldNode, Confinement] = {}
        self._known: frozenset[str] = frozenset()
        """The names of all stations that have ever been on it."""
        self._parked: dict[WorldNode, deque[Packet]] = {}
        """Packets that wait where a controller is off the bus, or where no node acknowledges its frames."""
        self._full: set[WorldNode] = set()
        """Stations whose transmit queue, ..."""
        self._overrun: set[WorldNode] = set()
        """... or receive queue overflows, and has reported it."""
        self._beyond: frozenset[str] = frozenset()
        """The stations on the far side of a cut."""
        self._swapped: frozenset[str] = frozenset()
        """The stations at which CAN high and CAN low are exchanged."""
        self._thrown_off: dict[str, Nanoseconds] = {}
        """Stations on their way off the bus, and until when they are to stay away."""

    def disturb(self, what: Disturbance, of: object = None) -> None:
        """Damage or lose frames from now on, as described; WorldError where a name was never on this wire.

        A station that is off the wire meets it when it is back. `of` is the cause, for `calm`.
        """
        for name in (what.sender, what.receiver):
            if name is not None and name not in self._known:
                self._named(name)
        self._standing.append(Standing(what, of))
        self._sound = False

    def calm(self, of: object) -> None:
        """End what was disturbed by this cause."""
        self._standing = [one for one in self._standing if one.of is not of]

    def cut(self, beyond: Collection[str]) -> None:
        """Cut the cable: the stations of these names receive from each other only, and so do the others."""
        self._beyond = frozenset(self._named(name).name for name in beyond)
        self._sound = False

    def swap(self, names: Collection[str]) -> None:
        """Exchange CAN high and CAN low at these stations.

        Such a station receives nothing and is not understood; while it has an unacknowledged frame, its
        repetitions destroy all other nodes' frames.
        """
        self._swapped = frozenset(self._named(name).name for name in names)
        self._sound = False

    def repair(self) -> None:
        """Put the cable right: neither cut nor swapped. What waited for an acknowledgement is sent."""
        self._beyond = self._swapped = frozenset()
        self._try_again()

    def throw_off(self, name: str, until: Nanoseconds) -> None:
        """Damage a station's frames until its controller is off the bus; no one restarts it till `until`."""
        self._thrown_off[self._named(name).name] = until
        self._sound = False

    def overrun(self, name: str, loss: Loss = Loss.UNKNOWN) -> None:
        """Have a station's controller report that it has lost a frame, without the frame itself."""
        self._report(self._named(name), CONTROLLER, RECEIVE_OVERFLOW, loss)

    def waiting(self, station: WorldNode) -> int:
        """Return how many frames of a station have not wholly left."""
        return len(self._controllers[station].queue) + len(self._parked.get(station, ()))

    def confinement(self, name: str) -> Confinement:
        """Return a station's error counters; WorldError where there is none of this name."""
        return self._counters[self._named(name)]

    def join(self, world: World, station: WorldNode, link: str) -> None:
        """Connect a station, which calls this wire `link`."""
        super().join(world, station, link)
        self._counters[station] = Confinement()
        self._known |= {station.name}
        self._try_again()

    def leave(self, station: WorldNode) -> None:
        """Disconnect a station."""
        super().leave(station)
        del self._counters[station]
        self._parked.pop(station, None)
        self._full.discard(station)
        self._overrun.discard(station)
        self._thrown_off.pop(station.name, None)

    def carry(self, sender: WorldNode, packet: Packet) -> None:
        """Queue a frame; a station that cannot send now sends it when it can."""
        if self._sound:
            super().carry(sender, packet)
            return
        if self._met(Effect.LOSS, sender) is not None:
            self.lost += 1
            return
        parked = self._parked.get(sender)
        waiting = self._controllers[sender].queue if parked is None else parked
        depth = self._depth if parked is None or self._depth is not None else WAITING
        if depth is not None and len(waiting) >= depth:
            self.lost += 1
            if sender not in self._full:  # reported once, until there is room again
                self._full.add(sender)
                self._report(sender, CONTROLLER, TRANSMIT_OVERFLOW, Loss.QUEUE)
        elif parked is None:
            super().carry(sender, packet)
        else:
            parked.append(packet)

    # Frames

    def _met(self, effect: Effect, sender: WorldNode) -> Disturbance | None:
        """Return the disturbance with this effect that meets a frame of this sender now."""
        now = self._ends.world.now
        for standing in self._standing:
            what = standing.what
            absent = what.receiver is not None and self._on_it(what.receiver) is None
            if what.effect is effect and not absent and standing.meets(sender.name, now):
                return what
        return None

    def _receiver(self, fault: Disturbance | None) -> WorldNode | None:
        return None if fault is None or fault.receiver is None else self._named(fault.receiver)

    def _spoilt(self, fault: Disturbance | None) -> tuple[WorldNode | None, bool]:
        """Return who alone sees a frame wrongly, if that is so, and whether its flag damages it for all."""
        receiver = self._receiver(fault)
        if receiver is None:
            return None, fault is not None
        # The flag of a passive controller is recessive: it spoils the frame for itself only.
        return receiver, self._counters[receiver].condition is Condition.ACTIVE

    def _finish(self, controller: Controller) -> None:
        sender = controller.station
        # The sender may have left the wire while its frame was under way.
        if self._sound or sender not in self._counters or controller.world.now >= sender.silent_from:
            super()._finish(controller)
            return
        hearers = self._hearers(sender)
        if not hearers:
            self._repeat(controller)
        else:
            wrong, damaged = self._spoilt(self._met(Effect.ERROR, sender))
            if damaged or sender.name in self._thrown_off or self._jammed():
                self._damage(controller, wrong, hearers)
            else:
                self._pass(controller, wrong, hearers)
        self._sound = self._is_sound()

    def _hearers(self, sender: WorldNode) -> list[WorldNode]:
        """Return the stations whose controllers receive a frame of this one, and acknowledge it."""
        if sender.name in self._swapped:
            return []
        side = sender.name in self._beyond
        return [
            station
            for station in self._counters
            if station is not sender
            and station not in self._parked
            and station.name not in self._swapped
            and (station.name in self._beyond) is side
        ]

    def _jammed(self) -> bool:
        """Return True if a station with swapped wires repeats a frame: its dominant bits cancel any other."""
        if not self._swapped:
            return False
        return any(self.waiting(one) > 0 for one in self._counters if one.name in self._swapped)

    def _pass(self, controller: Controller, wrong: WorldNode | None, hearers: list[WorldNode]) -> None:
        """End a frame that has gone well for all but one at most."""
        sender = controller.station
        full = self._receiver(self._met(Effect.OVERRUN, sender))
        not_receiving = {station for station in self._counters if station not in hearers} | {wrong, full}
        self._ends.not_receiving = frozenset(station for station in not_receiving if station is not None)
        super()._finish(controller)
        self._ends.not_receiving = frozenset()
        self._full.discard(sender)
        self._on_counters(sender, changed=self._counters[sender].sent())
        for station in hearers:
            counters = self._counters[station]
            missed = station is wrong
            self._on_counters(
                station, changed=counters.failed_to_receive(first=True) if missed else counters.received()
            )
        for station in hearers:
            if station is not full:
                self._overrun.discard(station)
            elif full not in self._overrun:  # reported once, until a frame gets through
                self._overrun.add(full)
                self._report(full, CONTROLLER, RECEIVE_OVERFLOW, Loss.OBJECT)

    def _damage(self, controller: Controller, first: WorldNode | None, hearers: list[WorldNode]) -> None:
        """End a frame with an error flag: all nodes count, and it waits to be sent again."""
        self.damaged += 1
        self._idle_after_flag(controller)
        self._on_counters(controller.station, changed=self._counters[controller.station].failed_to_send())
        for station in hearers:
            self._on_counters(
                station, changed=self._counters[station].failed_to_receive(first=station is first)
            )
        self._go_on()

    def _repeat(self, controller: Controller) -> None:
        """End a frame that no one acknowledges: until it is passive its sender counts, and sends it again."""
        sender = controller.station
        self._idle_after_flag(controller)
        counters = self._counters[sender]
        # Bosch CAN 2.0 B, section 8, rule 3, exception 1: a passive sender does not count a missing
        # acknowledge, so that a node alone on its bus never goes bus off.
        if counters.condition is Condition.ACTIVE:
            self._on_counters(sender, changed=counters.failed_to_send())
        else:
            self._parked[sender] = deque(packet for packet, _, _ in controller.queue)
            controller.queue.clear()
        self._go_on()

    def _idle_after_flag(self, controller: Controller) -> None:
        world, bits = controller.world, controller.queue[0][1]
        # The error flag comes in place of the end of frame, which the frame's length includes.
        taken = (FLAG_BITS - UNSENT_BITS + INTERFRAME_BITS) * self.bit_time
        self._idle_from = world.now + taken
        self._measure(world.now, bits * self.bit_time + taken)

    def _is_sound(self) -> bool:
        """Return True if all is well again, so that the next frame needs no second look."""
        now = self._ends.world.now
        self._standing = [one for one in self._standing if now < one.what.end and one.left != 0]
        faulty = (
            self._standing or self._parked or self._beyond or self._swapped or self._thrown_off or self._full
        )
        if faulty or self._depth is not None:
            return False
        return not any(one.transmit or one.receive for one in self._counters.values())

    # Controllers

    def _on_counters(self, station: WorldNode, *, changed: bool) -> None:
        if not changed:
            return
        counters = self._counters[station]
        if counters.condition is Condition.OFF:
            self._controllers[station].queue.clear()
            self._parked[station] = deque()
            world = self._ends.world
            back = world.now + RECOVERY_BITS * self.bit_time
            # A controller counts 128 x 11 recessive bits; a fault may keep it off for longer.
            world.call_at(max(back, self._thrown_off.pop(station.name, 0)), self._return, station)
            self._report(station, BUS_OFF)
        elif counters.condition is Condition.PASSIVE:
            # The larger of the two counters has made it passive.
            receiving = counters.receive > counters.transmit
            self._report(station, CONTROLLER, RECEIVE_PASSIVE if receiving else TRANSMIT_PASSIVE)
        else:
            self._report(station, CONTROLLER, ACTIVE_AGAIN)

    def _return(self, station: WorldNode) -> None:
        if station in self._parked and station in self._counters:
            self._counters[station].recover()
            self._report(station, RESTARTED)
            self._send_parked(station)
            self._try_again()

    def _try_again(self) -> None:
        """Send what waited for an acknowledgement, where there is someone to give it now."""
        for station in tuple(self._parked):
            if self._counters[station].condition is not Condition.OFF and self._hearers(station):
                self._send_parked(station)

    def _send_parked(self, station: WorldNode) -> None:
        for packet in self._parked.pop(station, ()):
            super().carry(station, packet)

    def _report(self, station: WorldNode, address: int, state: int = 0, loss: Loss = Loss.UNKNOWN) -> None:
        counters = self._counters[station]
        payload = encode_report(state, loss, counters.transmit, counters.receive)
        link = self._controllers[station].link
        self._ends.world.deliver(station, Packet(link, address, payload))

    def _on_it(self, name: str) -> WorldNode | None:
        return next((station for station in self._counters if station.name == name), None)

    def _named(self, name: str) -> WorldNode:
        station = self._on_it(name)
        if station is None:
            raise WorldError(f"there is no node '{name}' on wire '{self.name}'")
        return station
