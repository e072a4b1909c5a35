"""The IMU as a node on its line: a frame every 10 ms, and its faults.

Assumed:
* its clock is exact and begins at 0 with the run.
* a frame is handed to the UART at the sample's instant.
* it has no self-test, and takes nothing that is received.
"""

from collections.abc import Callable
from typing import Final

from emulators.imu.part import MemsPart
from emulators.imu.truth import Felt
from firmware_bridge.families.imu.wire import RATE_HZ, SEQUENCES, WRAP_MS, Counts, ImuFrame, Status, encoded
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

PERIOD: Final[Nanoseconds] = SECOND // RATE_HZ


def _swapped(values: Counts) -> Counts:
    x, y, z = values
    return y, x, z


class Imu:
    """One IMU; `frozen`, `swapped` and `silent` are set by faults."""

    def __init__(self, truth: Callable[[Nanoseconds], Felt], part: MemsPart) -> None:
        self._truth: Final = truth
        self.part: Final = part
        self.frozen = False
        """True while its values stay as they were."""
        self.swapped = False
        """True while x and y are exchanged."""
        self.silent = False
        """True while it sends nothing."""
        self._number = 0
        self._sequence = 0
        self._newest: tuple[Counts, Counts, Status] | None = None

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Ignore what is received."""
        del packet, now
        return Reaction((), self._next_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send the frames that are due."""
        sent: list[Packet] = []
        while self._next_at <= now:
            frame = self._frame(self._next_at)
            self._number += 1
            if not self.silent:
                sent.append(Packet(SERIAL, 0, encoded(frame)))
        return Reaction(tuple(sent), self._next_at)

    @property
    def _next_at(self) -> Nanoseconds:
        return self._number * PERIOD

    def _frame(self, at: Nanoseconds) -> ImuFrame:
        # Chance goes on in a frozen part, too: a fault changes nothing but its own effect.
        found = self.part.counts(self._truth(at))
        if not self.frozen or self._newest is None:
            self._newest = found
        force, rate, status = self._newest
        if self.swapped:
            force, rate = _swapped(force), _swapped(rate)
        sequence = self._sequence
        if not self.silent:
            self._sequence = (sequence + 1) % SEQUENCES
        return ImuFrame(sequence, int(status), at // MILLISECOND % WRAP_MS, force, rate)
