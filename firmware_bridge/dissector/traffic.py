"""The frames of the last second on a bus: how many of each identifier, the bits of all, the busiest burst."""

from collections import Counter, deque
from operator import itemgetter
from typing import Final

from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

RECENT: Final[Nanoseconds] = SECOND
"""Rates and load are those of this span."""
ADDRESS: Final = itemgetter(1)
BURST: Final[Nanoseconds] = 100 * MILLISECOND
"""The peak is the highest sum that any span of this length has seen."""


class Traffic:
    """Frames that came less than `RECENT` ago. Time must not step back."""

    def __init__(self) -> None:
        self.peak = 0
        """The most bits that a `BURST` ever had."""
        self._frames: deque[tuple[Nanoseconds, int, int]] = deque()
        """Instant, address and bits of each."""
        self._bits = 0
        """The bits of all of them."""
        self._burst: deque[list[int]] = deque()
        """The instants of the last burst, each with its bits."""
        self._burst_bits = 0

    def add(self, now: Nanoseconds, address: int, bits: int) -> None:
        """Take a frame of so many bits."""
        burst = self._burst
        self._frames.append((now, address, bits))
        self._bits += bits
        self._forget(now)
        # Frames that are received together have one instant.
        if burst and burst[-1][0] == now:
            burst[-1][1] += bits
        else:
            burst.append([now, bits])
            while burst[0][0] <= now - BURST:
                self._burst_bits -= burst.popleft()[1]
        self._burst_bits += bits
        # The highest sum is reached when something is added, never in between.
        self.peak = max(self.peak, self._burst_bits)

    def bits(self, now: Nanoseconds) -> int:
        """Return the bits of the frames of the last `RECENT`."""
        self._forget(now)
        return self._bits

    def frames(self, now: Nanoseconds) -> Counter[int]:
        """Return how many frames of each address came in the last `RECENT`."""
        self._forget(now)
        return Counter(map(ADDRESS, self._frames))

    def _forget(self, now: Nanoseconds) -> None:
        """Leave out the frames that came `RECENT` ago or earlier."""
        frames = self._frames
        while frames and frames[0][0] <= now - RECENT:
            self._bits -= frames.popleft()[2]
