"""Real time: the only reader of the clock, and the only place that sleeps."""

import select
import time
from collections.abc import Sequence

from firmware_bridge.units import NEVER, SECOND, Nanoseconds


class Clock:
    """Nanoseconds since the start of the run, which never step back or jump."""

    def __init__(self) -> None:
        self.started_at: Nanoseconds = 0
        """Unix time at which the run started, for recordings."""
        self._zero: Nanoseconds = 0
        self.restart()

    def restart(self) -> None:
        """Begin to count from zero."""
        self.started_at = time.time_ns()
        self._zero = time.monotonic_ns()

    def now(self) -> Nanoseconds:
        """Return the time since the start."""
        return time.monotonic_ns() - self._zero

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        """Sleep until a file can be read, or until an instant; return the files that can be read now."""
        timeout = None if until == NEVER else max(until - self.now(), 0) / SECOND
        # Not epoll: its time-outs are whole milliseconds, and there are only a few files.
        return select.select(filenos, (), (), timeout)[0]
