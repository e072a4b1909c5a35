"""The sum over the last span of time."""

from collections import deque

from firmware_bridge.units import Nanoseconds


class Lately:
    """The sum of amounts that came less than `span` ago. Time must not step back."""

    def __init__(self, span: Nanoseconds) -> None:
        self.span = span
        self.peak = 0
        """The highest sum that there ever was."""
        self._kept: deque[tuple[Nanoseconds, int]] = deque()
        self._sum = 0

    def add(self, now: Nanoseconds, amount: int) -> None:
        """Take an amount."""
        kept = self._kept
        kept.append((now, amount))
        self._sum += amount
        if kept[0][0] <= now - self.span:
            self.total(now)
        # The highest sum is reached when something is added, never in between.
        self.peak = max(self.peak, self._sum)

    def total(self, now: Nanoseconds) -> int:
        """Return the sum at an instant."""
        kept = self._kept
        while kept and kept[0][0] <= now - self.span:
            self._sum -= kept.popleft()[1]
        return self._sum
