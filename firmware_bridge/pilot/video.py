"""A camera's pictures as a station sees them: few a second, each old when it is shown.

Source: A. P. Das, PhD thesis, IIT Delhi, 2018, App. A and 6.1: two pictures a second, each 0.5 s old when it
is shown, processing included (9.2 s less 8.7 s on a filmed clock). What is seen is 0.5 s to 1 s old.
"""

from collections import deque
from dataclasses import dataclass
from typing import Final

from firmware_bridge.pilot.driver import Sight
from firmware_bridge.units import NEVER, Nanoseconds, from_seconds


@dataclass(frozen=True, slots=True)
class Video:
    """A video link; the defaults are the thesis's."""

    rate_hz: float = 2.0
    age_s: float = 0.5
    """Age of a picture when it is shown; a slower link shows it when it comes."""


class VideoFeed:
    """One robot's pictures; instants by the station's own clock."""

    def __init__(self, video: Video) -> None:
        self._period: Final[Nanoseconds] = from_seconds(1.0 / video.rate_hz)
        self._age: Final[Nanoseconds] = from_seconds(video.age_s)
        self._coming: Final[deque[tuple[Nanoseconds, Sight]]] = deque()
        """Pictures that are taken and not shown yet, with the instants when they are."""
        self._number = -1
        """Number of the newest picture, in periods since the clock's start."""

    @property
    def due(self) -> Nanoseconds:
        """Instant of the next picture; NEVER while none is on its way."""
        return self._coming[0][0] if self._coming else NEVER

    def filmed(self, sight: Sight) -> None:
        """Take a pose: the first one of a period is on the period's picture."""
        taken = sight.received_at if sight.measured_at is None else sight.measured_at
        # Datagrams may overtake one another; an earlier period has its picture.
        if (number := taken // self._period) <= self._number:
            return
        self._number = number
        self._coming.append((max(taken + self._age, sight.received_at), sight))

    def shown(self, now: Nanoseconds) -> Sight | None:
        """Return the newest picture that has become due, received now; None where none has."""
        newest = None
        while self._coming and self._coming[0][0] <= now:
            newest = self._coming.popleft()[1]
        return None if newest is None else newest._replace(received_at=now)
