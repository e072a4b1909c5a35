"""A CAN bus: one frame at a time, exact stuffed length, arbitration by identifier, interframe space, load.

Bit errors are not known here (`emulators.wires.faulty_can` does): a frame whose sender is cut off under way
is destroyed, all others arrive.
Every node has one queue, first in first out; the heads of the queues arbitrate.
"""

from collections import deque
from typing import Final

from emulators.wires.ends import End, Observed
from emulators.world import World, WorldError, WorldNode
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import INTERFRAME_BITS, arbitration_rank, frame_bits

WINDOW: Final = 100 * MILLISECOND
"""The peak load is the highest that any window of this length has seen."""


class Controller(End):
    """A station's CAN controller: what it wants to send, with the length in bits and the rank."""

    __slots__ = ("queue",)

    def __init__(self, station: WorldNode, link: str, world: World) -> None:
        super().__init__(station, link, world)
        self.queue: deque[tuple[Packet, int, int]] = deque()


class CanWire(Observed):
    """A CAN bus at `bit_rate` bits a second, which must divide a second into whole nanoseconds."""

    def __init__(self, bit_rate: int, name: str = "can") -> None:
        if bit_rate <= 0 or SECOND % bit_rate:
            raise WorldError(f"CAN bit rate {bit_rate}: a bit must last a whole number of nanoseconds")
        super().__init__(name)
        self.bit_time: Nanoseconds = SECOND // bit_rate
        self.frames = 0
        self.bits = 0
        """Bits of all frames from start to end of frame, without the spaces between them."""
        self.destroyed = 0
        self.clashes = 0
        """Number of times that two nodes began one identifier at once; a real bus then has a bit error."""
        self._controllers: dict[WorldNode, Controller] = {}
        self._contenders: list[Controller] = []
        """The controllers in the order in which they joined."""
        self._idle_from: Nanoseconds = 0
        self._busy = False
        self._recent: deque[tuple[Nanoseconds, Nanoseconds]] = deque()
        self._recent_time: Nanoseconds = 0
        self._peak_time: Nanoseconds = 0

    def join(self, world: World, station: WorldNode, link: str) -> None:
        """Connect a station, which calls this wire `link`."""
        controller = Controller(station, link, world)
        self._ends.join(controller)
        self._controllers[station] = controller
        self._contenders.append(controller)

    def leave(self, station: WorldNode) -> None:
        """Disconnect a station; a frame that it is sending is destroyed."""
        super().leave(station)
        self._contenders.remove(self._controllers.pop(station))

    def carry(self, sender: WorldNode, packet: Packet) -> None:
        """Queue a frame; ValueError for what is no frame."""
        address, controller = packet.address, self._controllers[sender]
        controller.queue.append((packet, frame_bits(address, packet.payload), arbitration_rank(address)))
        if not self._busy:
            # Not at once: others may begin at this very instant, and then the identifier decides.
            self._busy = True
            world = controller.world
            world.call_at(max(world.now, self._idle_from), self._arbitrate, world)

    def load_percent(self) -> float:
        """Return the part of the time so far in which the bus was taken, interframe spaces included."""
        now = self._ends.world.now
        return 100.0 * self._taken(self.bits, self.frames) / now if now else 0.0

    def peak_percent(self) -> float:
        """Return the load in the busiest window; a frame counts where it ends."""
        return min(100.0, 100.0 * self._peak_time / WINDOW)

    def _taken(self, bits: int, frames: int) -> Nanoseconds:
        return (bits + INTERFRAME_BITS * frames) * self.bit_time

    def _arbitrate(self, world: World) -> None:
        now = world.now
        winner: Controller | None = None
        best = 0
        for controller in self._contenders:
            queue = controller.queue
            if not queue:
                continue
            # A node that is cut off offers nothing, and its frames must not win the bus for ever.
            if now >= controller.station.silent_from:
                queue.clear()
                continue
            rank = queue[0][2]
            if winner is None or rank < best:
                # Dominant bits overwrite recessive ones: the lowest identifier goes on, the others wait.
                winner, best = controller, rank
            elif rank == best:
                self.clashes += 1
        if winner is None:
            self._busy = False
            return
        bits = winner.queue[0][1]
        world.call_at(now + bits * self.bit_time, self._finish, winner)

    def _finish(self, controller: Controller) -> None:
        now = controller.world.now
        packet, bits, _ = controller.queue.popleft()
        # Intermission: no node may begin before these bits have passed.
        self._idle_from = now + INTERFRAME_BITS * self.bit_time
        self.frames += 1
        self.bits += bits
        self._measure(now, self._taken(bits, 1))
        if now >= controller.station.silent_from:  # cut off, or detached, under way
            self.destroyed += 1
        else:
            self._ends.hand_over(controller.station, packet)
        self._go_on()

    def _go_on(self) -> None:
        """Let the next frame begin when the bus is idle again."""
        for other in self._contenders:
            if other.queue:
                other.world.call_at(self._idle_from, self._arbitrate, other.world)
                return
        self._busy = False

    def _measure(self, now: Nanoseconds, taken: Nanoseconds) -> None:
        recent, oldest = self._recent, now - WINDOW
        recent.append((now, taken))
        time = self._recent_time + taken
        while recent[0][0] <= oldest:
            time -= recent.popleft()[1]
        self._recent_time = time
        self._peak_time = max(self._peak_time, time)
