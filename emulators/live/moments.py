"""Moments of a bench that its time can go back to: one each second, the newest two minutes."""

from collections import deque
from typing import Final, Protocol

from emulators.rewind import Checkpoint
from firmware_bridge.units import SECOND, Nanoseconds

EVERY: Final[Nanoseconds] = SECOND
MOST: Final = 120


class Rewindable(Protocol):
    """A bench whose instants can be kept."""

    def snapshot(self) -> Checkpoint:
        """Keep this instant."""

    def restore(self, moment: Checkpoint) -> None:
        """Go to an instant that was kept."""

    def run(self, until: Nanoseconds) -> None:
        """Let time pass up to an instant."""


class Moments:
    """The kept moments of one bench, the oldest first."""

    def __init__(self, bench: Rewindable) -> None:
        self._bench: Final = bench
        self._kept: Final[deque[tuple[Nanoseconds, Checkpoint]]] = deque(maxlen=MOST)
        self._due: Nanoseconds = 0

    def keep(self, now: Nanoseconds) -> None:
        """Keep this instant where one is due."""
        if now >= self._due:
            self._kept.append((now, self._bench.snapshot()))
            self._due = now + EVERY

    @property
    def first(self) -> Nanoseconds | None:
        """The earliest instant to go back to; None before one was kept."""
        return self._kept[0][0] if self._kept else None

    def go_back(self, to: Nanoseconds) -> None:
        """Go back to an instant, and forget what came behind it; ValueError where it is not kept.

        Between two kept moments the bench runs by itself: what came from outside meanwhile is not repeated.
        """
        if self.first is None or to < self.first:
            raise ValueError("that instant is not kept any more")
        while self._kept[-1][0] > to:
            self._kept.pop()
        at, moment = self._kept[-1]
        self._bench.restore(moment)
        self._bench.run(to)
        self._due = at + EVERY
