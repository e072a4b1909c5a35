"""The clock that stamps poses, as this machine's clock: from stamps and their times of arrival.

No packet arrives early. So the least apparent travel time is the best possible one, and any excess of another
packet was jitter. The other clock may run faster or slower, so the least is forgotten slowly. The best time
itself cannot be known, and counts as none: on a wire it is under 1 ms.
"""

from typing import Final

from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.units import SECOND, Nanoseconds

_SKEW: Final = 10_000
"""A clock may gain or lose a second in so many: 100 ppm, three times what was seen."""
_RESTARTED: Final[Nanoseconds] = SECOND
"""A stamp that is off by more is of a clock that was set."""


class StampClock:
    """Turns stamps, in ns of another clock, into instants of this one."""

    def __init__(self) -> None:
        self._least: Nanoseconds | None = None
        """The least difference between arrival and stamp."""
        self._received_at: Nanoseconds = NEVER_RECEIVED

    def left_at(self, stamp: Nanoseconds, received_at: Nanoseconds) -> Nanoseconds:
        """Return when a packet with this stamp left, by our clock; never after it was received."""
        apart = received_at - stamp
        least = self._least
        # No jitter is a second long: the other clock was set, or its program started again.
        if least is None or abs(apart - least) > _RESTARTED:
            least = apart
        else:
            # The least creeps up with the time that passes, and no further than what is seen.
            least = min(least + (received_at - self._received_at) // _SKEW, apart)
        self._least, self._received_at = least, received_at
        return min(stamp + least, received_at)
