"""The sum over the last span of time."""

from collections import deque

from firmware_bridge.units import Nanoseconds


class Lately:
    """The sum of amounts that came less than `span` ago. Time must not step back."""

    def __init__(self, span: Nanoseconds) -> None:
        self.span = span
        self.peak = 0
        """The highest sum that there ever was."""
        self._times: deque[Nanoseconds] = deque()
        self._amounts: deque[int] = deque()
        """The sum of each of these instants."""
        self._sum = 0

    def add(self, now: Nanoseconds, amount: int) -> None:
        """Take an amount."""
        times, sum_ = self._times, self._sum + amount
        # Frames that are received together have one instant.
        if times and times[-1] == now:
            self._amounts[-1] += amount
        else:
            times.append(now)
            self._amounts.append(amount)
            # As in `total`, without the call: each frame of a bus comes through here.
            while times[0] <= now - self.span:
                times.popleft()
                sum_ -= self._amounts.popleft()
        self._sum = sum_
        # The highest sum is reached when something is added, never in between.
        self.peak = max(self.peak, sum_)

    def total(self, now: Nanoseconds) -> int:
        """Return the sum at an instant."""
        times = self._times
        while times and times[0] <= now - self.span:
            times.popleft()
            self._sum -= self._amounts.popleft()
        return self._sum
