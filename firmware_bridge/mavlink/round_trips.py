"""Quality of the link to one station: round trips of requests that it answers, frames lost by their gaps.

An answer counts once, and only to a request that is still open. Time is an argument; it sends nothing.
"""

from collections import deque
from typing import Final

from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

EVERY: Final[Nanoseconds] = 500 * MILLISECOND
"""Between two requests: 150 bytes a second to the station in control, and to no other."""
MOST_OPEN: Final = 20
"""Questions that wait for an answer: those of ten seconds."""
NEWEST_OVER: Final[Nanoseconds] = 3 * SECOND
"""Period whose least round trip is reported: one delayed answer does not count."""
LOSS_OVER: Final[Nanoseconds] = 5 * SECOND
_NUMBERS: Final = 256
_HALF: Final = 128


class RoundTrips:
    """The open questions, and how long the newest answers took."""

    __slots__ = ("_lasted", "_open", "began_at", "due")

    def __init__(self) -> None:
        self._open: Final[dict[tuple[int, int], Nanoseconds]] = {}
        """Time of each request, by the message's number and its returned value."""
        self._lasted: Final[deque[tuple[Nanoseconds, Nanoseconds]]] = deque()
        """Times of answers, with their round trips."""
        self.began_at: Nanoseconds | None = None
        """Time of the first request."""
        self.due: Nanoseconds = 0
        """Time of the next request."""

    def ask(self, *questions: tuple[int, int], now: Nanoseconds) -> None:
        """Take note of questions that are sent now; the next are due `EVERY` later."""
        self.began_at = now if self.began_at is None else self.began_at
        self.due = now + EVERY
        for question in questions:
            self._open[question] = now
        # The oldest goes: its answer would be useless by now.
        while len(self._open) > MOST_OPEN:
            del self._open[next(iter(self._open))]

    def answered(self, question: tuple[int, int], now: Nanoseconds) -> Nanoseconds | None:
        """Return the time of the request that is answered now; None for one unknown or no longer open."""
        requested_at = self._open.pop(question, None)
        if requested_at is not None:
            self._lasted.append((now, now - requested_at))
        return requested_at

    def newest(self, now: Nanoseconds) -> Nanoseconds | None:
        """Return the round trip of the last seconds, None where nothing was answered in them."""
        lasted = self._lasted
        while lasted and now - lasted[0][0] > NEWEST_OVER:
            lasted.popleft()
        return min([trip for _, trip in lasted], default=None)


class Losses:
    """Missing share of a station's frames, from the gaps in its sequence numbers."""

    __slots__ = ("_came", "_missing", "_newest", "_until", "share")

    def __init__(self) -> None:
        self._newest: int | None = None
        self._came = 0
        self._missing = 0
        self._until: Nanoseconds = 0
        self.share: float | None = None
        """Of the last five seconds that are over; None before."""

    def received(self, sequence: int, now: Nanoseconds) -> None:
        """Take note of a frame; one that comes late is missing no more, one that comes twice counts once."""
        if self._newest is None:
            self._until = now + LOSS_OVER
        elif now >= self._until:
            self.share = self._missing / max(self._missing + self._came, 1)
            self._came = self._missing = 0
            self._until = now + LOSS_OVER
        # Eight bits: more than half of the numbers ahead is behind.
        ahead = 1 if self._newest is None else (sequence - self._newest) % _NUMBERS
        if 0 < ahead < _HALF:
            self._missing += ahead - 1
            self._newest = sequence
            self._came += 1
        # It was counted as missing, and came late.
        elif ahead and self._missing:
            self._missing -= 1
            self._came += 1
