"""Detection of two stations under one system and component: behind a router both come from one place.

A station numbers its frames one after the other. Of two stations the numbers go back and forth: by further
than a frame is overtaken on its way, or, where the two are near, to a number that was used, with another
content. A frame that is doubled or overtaken does not look so.
"""

from collections import deque
from typing import Final

from firmware_bridge.units import SECOND, Nanoseconds

LEAST: Final = 5
"""So often the numbers go back to one that was used before two stations are seen in that ..."""
WITHIN: Final[Nanoseconds] = 3 * SECOND
"""... in this time; a station that begins again does it once."""
FAR: Final = 64
"""A step back by more than this: a frame that so many others have overtaken would be too old to count.

Nearer ones look like a link that delivers late, until a number comes again.
"""
FAR_LEAST: Final = 3
"""So often the numbers go back that far before two stations are seen in that ..."""
FAR_WITHIN: Final[Nanoseconds] = SECOND
"""... in this time."""
GONE: Final[Nanoseconds] = 2 * SECOND
"""Silence after which a station is gone, or has begun again."""
NEAR: Final = 32
"""A number so far ahead at most is of the station whose newest frame that was: others were lost."""
KEPT: Final = 300
_ALL, _HALF = 0x100, 0x80


class Numbered:
    """The numbers of the frames of one system and component at one place."""

    __slots__ = ("_back", "_far", "_first", "_newest", "_next", "_received", "_second", "two")

    def __init__(self) -> None:
        self._newest: tuple[int, int] | None = None
        """The newest frame's number, and the same counted on over its eight bits."""
        self._received: Final[dict[int, int]] = {}
        """The content of the newest frames, by their numbers as they are counted on."""
        self._back: Final[deque[Nanoseconds]] = deque(maxlen=LEAST)
        """Times of the returns to a number that was used."""
        self._far: Final[deque[Nanoseconds]] = deque(maxlen=FAR_LEAST)
        """Times of the steps far back."""
        self._first: tuple[int, Nanoseconds] | None = None
        self._second: tuple[int, Nanoseconds] | None = None
        """The newest frame of who was there first, and of who came later."""
        self._next = -1
        """The first station's next expected number before its newest gap."""
        self.two = False
        """True where two stations send."""

    def receive(self, number: int, content: int, now: Nanoseconds) -> bool:
        """Take a frame, its content as a checksum; return whether it is of the station that came later."""
        if self._newest is None:
            self._newest = number, number
        # To the nearest of the 256 numbers, forwards or backwards.
        step = (number - self._newest[0] + _HALF) % _ALL - _HALF
        place = self._newest[1] + step
        before = self._received.get(place)
        # The same number and the same bytes: the network has sent it twice.
        if before == content:
            return False  # the network has doubled it
        # The same number with other bytes: one station does not count like that.
        if before is not None and step <= 0:
            self._back.append(now)
        if step < -FAR:
            self._far.append(now)
        self._newest = number, place
        self._received[place] = content
        if len(self._received) > KEPT:
            del self._received[next(iter(self._received))]
        self.two = _often(self._back, now, WITHIN) or _often(self._far, now, FAR_WITHIN)
        return self._is_later(number, now) and self.two

    def _is_later(self, number: int, now: Nanoseconds) -> bool:
        """Return of whom a frame is: of whose newest one it follows next."""
        first = self._first
        if first is None or now - first[1] > GONE:
            first, self._second = self._second or ((number - 1) % _ALL, now), None
        second, newest = self._second, (number, now)
        # How far the number is behind each station's next one; the nearer one has sent it.
        after_first = (number - first[0] - 1) % _ALL
        after_second = _ALL if second is None else (number - second[0] - 1) % _ALL
        later = after_first >= NEAR or after_second < after_first
        if later and second is None and number == self._next:
            # What looked like lost frames of the first was another one that had joined ahead of it.
            self._first, self._second, later = newest, first, False
        else:
            self._next = (first[0] + 1) % _ALL if after_first else self._next
            self._first, self._second = (first, newest) if later else (newest, second)
        return later


def _often(times: deque[Nanoseconds], now: Nanoseconds, within: Nanoseconds) -> bool:
    """Return whether as many as are counted were within this time."""
    return len(times) == times.maxlen and now - times[0] <= within
