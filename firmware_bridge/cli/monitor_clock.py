"""The clock of `monitor` on a terminal: on a busy bus it wakes for some frames together."""

from collections.abc import Sequence
from typing import Final

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND, Nanoseconds

TOGETHER: Final[Nanoseconds] = 2 * MILLISECOND
"""Frames of such a span are received together: to wake for a frame costs more than to note it. An interface
keeps some hundred of them, more than a bus can carry in that time."""
BUSY: Final[Nanoseconds] = 2 * TOGETHER
"""A bus is busy whose frames come closer."""


class GatheringClock(Clock):
    """A clock that lets frames gather; on a busy bus their instant may be so much later."""

    def __init__(self) -> None:
        self._woken_at: Nanoseconds = -BUSY
        self._busy = False
        super().__init__()

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        """Sleep as a clock does; where frames came just before, for a little while at least."""
        if self._busy:
            super().wait((), min(until, self.now() + TOGETHER))
        ready = super().wait(filenos, until)
        now = self.now()
        self._busy = bool(ready) and now - self._woken_at < BUSY
        self._woken_at = now
        return ready
