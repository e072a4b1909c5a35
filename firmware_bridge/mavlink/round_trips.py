"""Round trips of the requests that one station answers.

An answer counts once, and only to a request that is still open. Time is an argument; it sends nothing.
"""

from collections import deque
from typing import Final

from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

EVERY: Final[Nanoseconds] = 500 * MILLISECOND
"""Between two requests: 150 bytes a second to the station in control, and to no other."""
MOST_OPEN: Final = 20
"""Questions that wait for an answer: those of ten seconds."""
NEWEST_OVER: Final[Nanoseconds] = 3 * SECOND
"""Period whose least round trip is reported: one delayed answer does not count."""


class RoundTrips:
    """The open questions, and how long the newest answers took."""

    __slots__ = ("_lasted", "_open", "began_at", "due", "least", "least_until")

    def __init__(self) -> None:
        self._open: Final[dict[tuple[int, int], Nanoseconds]] = {}
        """Time of each request, by the message's number and its returned value."""
        self._lasted: Final[deque[tuple[Nanoseconds, Nanoseconds]]] = deque()
        """Times of answers, with their round trips."""
        self.began_at: Nanoseconds | None = None
        """Time of the first request."""
        self.due: Nanoseconds = 0
        """Time of the next request."""
        self.least: Nanoseconds | None = None
        """The round trip that `newest` returns until `least_until`."""
        self.least_until: Nanoseconds = NEVER

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
            self.newest(now)
        return requested_at

    def newest(self, now: Nanoseconds) -> Nanoseconds | None:
        """Return the round trip of the last seconds, None where nothing was answered in them."""
        lasted = self._lasted
        while lasted and now - lasted[0][0] > NEWEST_OVER:
            lasted.popleft()
        self.least = min([trip for _, trip in lasted], default=None)
        self.least_until = lasted[0][0] + NEWEST_OVER if lasted else NEVER
        return self.least
