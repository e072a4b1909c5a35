"""Real time: the only reader of the clock, and the only place that sleeps."""

import select
import time
from collections.abc import Sequence
from typing import Final

from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, SECOND, Nanoseconds

STALL: Final = 50 * MILLISECOND
"""A process that is not let run for longer has been stopped; a shorter time is a busy machine's."""


class Clock:
    """Nanoseconds since the start of the run, which never step back or jump."""

    def __init__(self) -> None:
        self.started_at: Nanoseconds = 0
        """Unix time at which the run started, for recordings."""
        self._zero: Nanoseconds = 0
        self.restart()

    def restart(self) -> None:
        """Begin to count from zero."""
        # Two clocks: the wall clock may step, and only dates the recording; time itself is monotonic.
        self.started_at = time.time_ns()
        self._zero = time.monotonic_ns()

    def now(self) -> Nanoseconds:
        """Return the time since the start, in whole microseconds, the resolution of recordings."""
        return (time.monotonic_ns() - self._zero) // MICROSECOND * MICROSECOND

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        """Sleep until a file can be read, or until an instant; return the files that can be read now."""
        timeout = None if until == NEVER else max(until - self.now(), 0) / SECOND
        # Not epoll: its time-outs are whole milliseconds, and there are only a few files.
        return select.select(filenos, (), (), timeout)[0]


def resolution() -> Nanoseconds:
    """Return the step of the clock, as the system reports it; at least one nanosecond."""
    return max(1, round(time.get_clock_info("monotonic").resolution * SECOND))


class LivedClock(Clock):
    """A clock that counts only the time in which the process ran, for emulated devices.

    A device that was stopped by its machine for 0.7 s has not waited 0.7 s for its host: bytes that the host
    sent meanwhile, and that arrive at once now, have come in time. A bridge must not have it: a robot moves
    on.
    """

    def __init__(self) -> None:
        self.stalls = 0
        self.stalled: Nanoseconds = 0
        """Total time of standing still."""
        super().__init__()

    def restart(self) -> None:
        """Begin to count from zero, with no stall yet."""
        super().restart()
        self.stalls, self.stalled = 0, 0
        self._seen: Nanoseconds = 0

    def now(self) -> Nanoseconds:
        """Return the time that was lived since the start."""
        return self._see(self._seen)

    def wait(self, filenos: Sequence[int], until: Nanoseconds) -> list[int]:
        """Sleep as a clock does; what goes on beyond the instant was not meant."""
        self.now()
        ready = super().wait(filenos, until)
        self._see(max(self._seen, until))
        return ready

    def _see(self, expected: Nanoseconds) -> Nanoseconds:
        now = super().now() - self.stalled
        # A process that was stopped has lived no time: the difference is taken out once and for all.
        if now - expected > STALL:
            self.stalls += 1
            self.stalled += now - expected
            now = expected
        self._seen = max(self._seen, now)
        return self._seen
