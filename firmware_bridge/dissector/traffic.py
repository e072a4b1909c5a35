"""The frames of the last second on a bus: how many of each identifier, the bits of all, the busiest burst."""

from collections import Counter, deque
from typing import Final

from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

RECENT: Final[Nanoseconds] = SECOND
"""Rates and load are those of this span."""
BURST: Final[Nanoseconds] = 100 * MILLISECOND
"""The peak is the highest sum that any span of this length has seen."""


class Traffic:
    """Frames that came less than `RECENT` ago. Time must not step back."""

    def __init__(self) -> None:
        self.peak = 0
        """The most bits that a `BURST` ever had."""
        self._frames: deque[tuple[Nanoseconds, int, int]] = deque()
        """Instant, address and bits of each."""
        self._burst: deque[list[int]] = deque()
        """The instants of the last burst, each with its bits."""
        self._burst_bits = 0

    def add(self, now: Nanoseconds, address: int, bits: int) -> None:
        """Take a frame of so many bits."""
        frames, burst = self._frames, self._burst
        frames.append((now, address, bits))
        while frames[0][0] <= now - RECENT:
            frames.popleft()
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
        return sum(bits for at, _, bits in self._frames if at > now - RECENT)

    def frames(self, now: Nanoseconds) -> Counter[int]:
        """Return how many frames of each address came in the last `RECENT`."""
        return Counter(address for at, address, _ in self._frames if at > now - RECENT)
