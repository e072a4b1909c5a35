"""How good the link to one station is: round trips of questions that it answers, frames lost by their gaps.

An answer counts once, and only to a question that is still open. Time is an argument; it sends nothing.
"""

from collections import deque
from typing import Final

from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

EVERY: Final[Nanoseconds] = 500 * MILLISECOND
"""Between two questions: 150 bytes a second to who drives, and to no one else."""
MOST_OPEN: Final = 20
"""Questions that wait for an answer: those of ten seconds."""
NEWEST_OVER: Final[Nanoseconds] = 3 * SECOND
"""The round trip that is told is the least of so long: one answer that was held up says nothing."""
LOSS_OVER: Final[Nanoseconds] = 5 * SECOND
_NUMBERS: Final = 256
_HALF: Final = 128


class RoundTrips:
    """The open questions, and how long the newest answers took."""

    __slots__ = ("_lasted", "_open", "began_at", "due")

    def __init__(self) -> None:
        self._open: Final[dict[tuple[int, int], Nanoseconds]] = {}
        """When each was asked, by the message's number and what it carries back."""
        self._lasted: Final[deque[tuple[Nanoseconds, Nanoseconds]]] = deque()
        """When answers came, and how long they took."""
        self.began_at: Nanoseconds | None = None
        """When the first question was asked."""
        self.due: Nanoseconds = 0
        """When the next question is due."""

    def ask(self, *questions: tuple[int, int], now: Nanoseconds) -> None:
        """Take note of questions that are sent now; the next are due `EVERY` later."""
        self.began_at = now if self.began_at is None else self.began_at
        self.due = now + EVERY
        for question in questions:
            self._open[question] = now
        while len(self._open) > MOST_OPEN:
            del self._open[next(iter(self._open))]

    def answered(self, question: tuple[int, int], now: Nanoseconds) -> Nanoseconds | None:
        """Return when a question was asked that is answered now; None for one that was not, or no more."""
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
    """Which share of a station's frames is missing, from the gaps in its sequence numbers."""

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
        ahead = 1 if self._newest is None else (sequence - self._newest) % _NUMBERS
        if 0 < ahead < _HALF:
            self._missing += ahead - 1
            self._newest = sequence
            self._came += 1
        elif ahead and self._missing:
            self._missing -= 1
            self._came += 1
