"""One clock of a station against ours: the bounds of its offset, from observation alone.

A station that answers has read its clock after the request was sent and before its answer came: that bounds
the offset from both sides. A station that sends a message has read it before the message came: that bounds it
from one. All bounds hold at once, each as wide as the drift since has made it; where they contradict one
another, the clock was set, or is none. Nothing here knows MAVLink. Instants and readings in nanoseconds; an
offset is our time less theirs.
"""

from typing import Final

from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

DRIFT: Final = 10_000
"""Two clocks part by one nanosecond in so many at most: 100 ppm."""
TOLERANCE: Final[Nanoseconds] = 20 * MILLISECOND
"""So much a reading may be ahead: stamps of frames that are written at once count up before the clock."""
PROVEN_AFTER: Final[Nanoseconds] = 200 * MILLISECOND
"""A clock has run between two answers that are so far apart; what only counts frames contradicts itself."""
EXPIRES_AFTER: Final[Nanoseconds] = 10 * SECOND
"""A clock that is not read for so long may have been set since."""
LEAST_OVER: Final[Nanoseconds] = 30 * SECOND
"""The least delay is that of one to two such windows."""
_RUNS_AFTER: Final[Nanoseconds] = SECOND


class AnsweredClock:
    """A clock whose owner answers requests."""

    __slots__ = ("_at", "_high", "_low", "_proven", "_read_at", "_since")

    def __init__(self) -> None:
        self._low: Nanoseconds | None = None
        """None while nothing is known."""
        self._high: Nanoseconds = 0
        self._at: Nanoseconds = 0
        """Time of these bounds; they widen since."""
        self._since: Nanoseconds = 0
        """Time of the first answer of this clock."""
        self._read_at: Nanoseconds = 0
        self._proven = False

    def answered(
        self, requested_at: Nanoseconds, reading: Nanoseconds, came_at: Nanoseconds, resolution: Nanoseconds
    ) -> None:
        """Take an answer: between these instants the clock showed `reading`, rounded down."""
        # Their clock was read after the request had left and before the answer came.
        low, high = requested_at - reading - resolution, came_at - reading
        known = self._bounds(came_at)
        # Bounds that do not overlap cannot both be true: the clock was set, and is proved again.
        if known is None or low > known[1] + TOLERANCE or high < known[0] - TOLERANCE:
            self._proven, self._since = False, came_at
        else:
            low, high = max(low, known[0]), min(high, known[1])
            self._proven = self._proven or requested_at - self._since >= PROVEN_AFTER
        # Within the tolerance they may have crossed by a little.
        self._low, self._high = min(low, high), max(low, high)
        self._at = self._read_at = came_at

    def age(self, reading: Nanoseconds, now: Nanoseconds) -> Nanoseconds | None:
        """Return the age of a message that arrives now, sent when the clock showed this; None: not known.

        It is off by half the shortest round trip at most, beside drift and resolution. The message itself is
        a bound: a clock that it contradicts has been set, and is not known any more.
        """
        known = self._bounds(now)
        if known is None:
            return None
        low, high = known
        if self.contradicts(reading, now):
            self._low, self._proven = None, False
            return None
        # A message cannot arrive before it was sent, which bounds the offset from above.
        if now - reading < high:
            high = max(now - reading, low)
            self._low, self._high, self._at = low, high, now
        if not self._proven:
            return None
        return max(now - reading - (low + high) // 2, 0)

    def contradicts(self, reading: Nanoseconds, now: Nanoseconds) -> bool:
        """Return whether a message that arrives now was never sent when this clock showed `reading`."""
        known = self._bounds(now)
        return known is not None and now - reading < known[0] - TOLERANCE

    def shows(self, now: Nanoseconds) -> Nanoseconds | None:
        """Return what the clock shows now, or None where it is not known."""
        offset = self.offset(now)
        return None if offset is None or not self._proven else now - offset[0]

    def offset(self, now: Nanoseconds) -> tuple[Nanoseconds, Nanoseconds] | None:
        """Return our time less its time, and by how much that may be wrong; None where it is not known.

        Known from its first answer on: whether it runs at all is not proven yet.
        """
        known = self._bounds(now)
        return None if known is None else ((known[0] + known[1]) // 2, (known[1] - known[0] + 1) // 2)

    def _bounds(self, now: Nanoseconds) -> tuple[Nanoseconds, Nanoseconds] | None:
        if self._low is None or now - self._read_at > EXPIRES_AFTER:
            return None
        # Rounded up: the bounds must never be narrower than the drift allows.
        wider = -(-(now - self._at) // DRIFT)
        return self._low - wider, self._high + wider


class ReceivedClock:
    """A clock without answers: only the delay of a message relative to the fastest one is known.

    Where it was set back, its messages seem old. An answered clock of the same station that was set as well
    shows by how much: the bounds so far are then kept, moved by that.
    """

    __slots__ = ("_before", "_began_at", "_began_with", "_least", "_newest", "_offset", "_runs", "_since")

    def __init__(self) -> None:
        self._before: Nanoseconds | None = None
        """The least of the window before this one."""
        self._least: Nanoseconds | None = None
        """The least of arrival less reading in this window."""
        self._began_at: Nanoseconds = 0
        self._began_with: Nanoseconds = 0
        """The reading at its begin."""
        self._newest: Nanoseconds = 0
        self._runs = False
        """True where it has been seen to run about as fast as ours."""
        self._offset: tuple[Nanoseconds, Nanoseconds] | None = None
        """The answered clock's at the last message that was not later than it may be."""
        self._since: Nanoseconds | None = None
        """The least excess since then."""

    def set_with(
        self, answered: AnsweredClock, reading: Nanoseconds, now: Nanoseconds, limit: Nanoseconds
    ) -> None:
        """Find whether this clock was set together with the answered one; a message of `reading` arrives now.

        It was, if every message since the last one that came within `limit` seems older by at least the step
        by which the answered one was set back. A message that seems less old was sent by a clock that was set
        otherwise.
        """
        excess, offset = self.excess(reading, now), answered.offset(now)
        if excess is None or excess <= limit:
            self._offset, self._since = offset, None
            return
        self._since = excess if self._since is None else min(self._since, excess)
        if self._offset is None or offset is None or answered.shows(now) is None:
            return
        by = offset[0] - self._offset[0]
        uncertain = offset[1] + self._offset[1] + TOLERANCE
        # Only where the step is larger than what both estimates may be wrong by.
        if by > uncertain and self._since >= by - uncertain:
            self._move(by)
            self._offset, self._since = offset, None

    def _move(self, by: Nanoseconds) -> None:
        """Take every message so far as sent by the clock that was set back by so much."""
        self._least = None if self._least is None else self._least + by
        self._before = None if self._before is None else self._before + by
        self._began_with -= by

    def excess(self, reading: Nanoseconds, now: Nanoseconds) -> Nanoseconds | None:
        """Return this message's delay behind the fastest one; None for what is no clock that runs."""
        late = now - reading
        # Two windows in turn: a least delay of hours ago is of no use on a clock that drifts.
        if self._least is None or now - self._began_at >= LEAST_OVER:
            self._before, self._least = self._least, late
            self._began_at, self._began_with = now, reading
        self._least = min(self._least, late)
        elapsed = now - self._began_at
        if elapsed >= _RUNS_AFTER:
            # A stamp that counts frames does not run with time: half to double the pace is a clock.
            self._runs = self._runs or elapsed // 2 <= reading - self._began_with <= 2 * elapsed
        least = self._least if self._before is None else min(self._least, self._before)
        return late - least if self._runs else None
