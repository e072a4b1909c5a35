"""The board's own time: millis() that skips, micros() in fours.

Source: ArduinoCore-avr, wiring.c: timer 0 overflows every 1024 us; each adds 1 ms, and 3/125 that are
carried, so that about every 42 ms one value is never seen.
"""

from typing import Final

from firmware_bridge.units import MICROSECOND, Nanoseconds

OVERFLOW: Final[Nanoseconds] = 1_024 * MICROSECOND
TICK: Final[Nanoseconds] = 4 * MICROSECOND
FRACTION: Final = 3
WHOLE: Final = 125
WORD: Final = 1 << 32


class Clock:
    """Clock that runs from the setup of the timer by the sketch's processor."""

    def __init__(self, started_at: Nanoseconds) -> None:
        self.started_at: Final = started_at

    def millis(self, now: Nanoseconds) -> int:
        """Return milliseconds as they stand after the interrupt; unsigned, 32 bits."""
        return self._total(now) % WORD

    def micros(self, now: Nanoseconds) -> int:
        """Return microseconds, a multiple of 4; unsigned, 32 bits."""
        return (now - self.started_at) // TICK * (TICK // MICROSECOND) % WORD

    def shows(self, value: int, now: Nanoseconds) -> Nanoseconds:
        """Return when millis() first is `value` or later; `now` where it is.

        `value` is a word of 32 bits, and less than half its range away.
        """
        total = self._total(now)
        ahead = (value - total) % WORD
        if ahead == 0 or ahead >= WORD // 2:
            return now
        # An overflow is 128/125 ms: the first one at which the total is there, rounded up.
        overflows = -(-WHOLE * (total + ahead) // (WHOLE + FRACTION))
        return self.started_at + overflows * OVERFLOW

    def _total(self, now: Nanoseconds) -> int:
        overflows = (now - self.started_at) // OVERFLOW
        return overflows + FRACTION * overflows // WHOLE
