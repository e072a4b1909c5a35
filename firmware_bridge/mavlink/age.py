"""The age of a station's messages at their arrival: a row for each way to find it, the best first.

Each of them alone bounds the age from below: a message is as old as the row with the largest age reports. The
best row dates it, unless another one contradicts it by more than an age may be: a station whose TIMESYNC runs
behind the clock of its set-points would make old messages young. Only the clocks of the station in control
are followed, and only by its own answers. Sources: mavlink.io, "Time Synchronization Protocol v2" (TIMESYNC),
"Message Signing"; common.xml, PING, SET_POSITION_TARGET_LOCAL_NED.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeAlias

from firmware_bridge.mavlink.clock_fit import AnsweredClock, ReceivedClock
from firmware_bridge.mavlink.frames import Losses, Message, dialect
from firmware_bridge.mavlink.round_trips import RoundTrips
from firmware_bridge.mavlink.trust import UNIT, stamp_of
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

TIED_WITHIN: Final[Nanoseconds] = 2 * SECOND
"""A set-point's time that TIMESYNC's clock makes older at first is another clock's."""
BOOT_WRAPS: Final = 1 << 32
"""Of `time_boot_ms`, in milliseconds."""
_TIMESYNC: Final = dialect.MAVLINK_MSG_ID_TIMESYNC
_PING: Final = dialect.MAVLINK_MSG_ID_PING
SET_POINT: Final = dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED
_GRAIN: Final[Nanoseconds] = 1_000
"""Resolution of instants here: whole microseconds, as recordings keep them, so that a replay is equal."""
_LARGEST_PING: Final = 0xFFFF_FFFF
_ANYONE: Final = (0, 0)


class Age(NamedTuple):
    """Age of a message."""

    nanoseconds: Nanoseconds
    timestamped: bool
    """True where that is exact to within half a round trip; else it is a lower bound."""


def boot_ms(message: Message) -> int | None:
    """Return the time that a set-point carries, in ms since its station began; None where it carries none."""
    if message.get_msgId() != SET_POINT or message.time_boot_ms == 0:
        return None
    time: int = message.time_boot_ms
    return time


class Ages:
    """One station's clocks and its link."""

    def __init__(self, *, signed: bool) -> None:
        """Begin to know nothing; `signed`: signatures are checked, so that their stamps are the station's."""
        self.signed: Final = signed
        self.trips: Final = RoundTrips()
        self.losses: Final = Losses()
        self.synced: Final = AnsweredClock()
        """The clock that TIMESYNC reports."""
        self.stamped: Final = AnsweredClock()
        """The one that stamps its frames, if it is one."""
        self.received_boot: Final = ReceivedClock()
        self.received_stamps: Final = ReceivedClock()
        self.tied = False
        """True where the set-points' times have been found to be of TIMESYNC's clock."""
        self._boot: Nanoseconds | None = None
        """The newest set-point's time, unwrapped."""
        self.differs: Nanoseconds = 0
        """Excess of a message's age by another row over that by the row that dates it."""
        self._pings = 0

    def questions(self, now: Nanoseconds) -> list[Message]:
        """Return the requests that are due: some stations answer TIMESYNC, others only PING."""
        if now < self.trips.due:
            return []
        self._pings = self._pings % _LARGEST_PING + 1
        # Never 0, and whole microseconds: the answer must return this very value.
        requested_at = max(_whole(now), _GRAIN)
        self.trips.ask((_TIMESYNC, requested_at), (_PING, self._pings), now=_whole(now))
        return [
            dialect.MAVLink_timesync_message(0, requested_at),
            # Target 0, 0: a ping request; an answer names its receiver (common.xml, PING).
            dialect.MAVLink_ping_message(now // 1000, self._pings, *_ANYONE),
        ]

    def answered(self, message: Message, now: Nanoseconds) -> None:
        """Take an answer of this station; one to no open request is ignored."""
        syncs = message.get_msgId() == _TIMESYNC
        carried = message.ts1 if syncs else message.seq
        now = _whole(now)
        requested_at = self.trips.answered((message.get_msgId(), carried), now)
        if requested_at is None:
            return
        if syncs:
            self.synced.answered(requested_at, message.tc1, now, 1)
        stamp = self._stamp(message)
        if stamp is not None:
            self.stamped.answered(requested_at, stamp, now, UNIT)

    def age(self, message: Message, now: Nanoseconds, limit: Nanoseconds) -> Age | None:
        """Return the age of a message that arrives now; None where no row gives one.

        Rows that differ by more than `limit` do not date it.
        """
        self._follow_what_was_set(message, _whole(now), limit)
        found = [(row.age_of(self, message, _whole(now)), row.timestamped) for row in ROWS]
        ages = [(age, timestamped) for age, timestamped in found if age is not None]
        if not ages:
            return None
        # Each row bounds the age from below, so the largest is the one that holds.
        oldest = max(age for age, _ in ages)
        best, timestamped = ages[0]
        if timestamped:
            self.differs = oldest - best
        return Age(oldest, timestamped and oldest - best <= limit)

    def _follow_what_was_set(self, message: Message, now: Nanoseconds, limit: Nanoseconds) -> None:
        """Move the fastest message of a clock that was set back, by as much as its answers have shown."""
        time, stamp = self._unwrapped(message), self._stamp(message)
        if time is not None:
            self.received_boot.set_with(self.synced, time, now, limit)
        if stamp is not None:
            self.received_stamps.set_with(self.stamped, stamp, now, limit)

    def by_set_point(self, message: Message, now: Nanoseconds) -> Nanoseconds | None:
        """Map a set-point's time by TIMESYNC, once it has been found to be of the same clock."""
        time, shows = boot_ms(message), self.synced.shows(now)
        if time is None or shows is None:
            return None
        # time_boot_ms wraps after 49.7 days: the difference is taken to the nearest wrap.
        around = BOOT_WRAPS * MILLISECOND
        behind = (shows - time * MILLISECOND + around // 2) % around - around // 2
        reading = shows - behind
        # A first reading that is too old may be of another clock; it must not make all commands stale.
        if not self.tied and (behind >= TIED_WITHIN or self.synced.contradicts(reading, now)):
            return None
        age = self.synced.age(reading, now)
        self.tied = age is not None
        return age

    def by_signature(self, message: Message, now: Nanoseconds) -> Nanoseconds | None:
        """Take a signature's stamp by the stamps of the station's answers."""
        stamp = self._stamp(message)
        return None if stamp is None else self.stamped.age(stamp, now)

    def above_fastest_set_point(self, message: Message, now: Nanoseconds) -> Nanoseconds | None:
        """Take a set-point's time as that of a clock that no one answers for."""
        time = self._unwrapped(message)
        return None if time is None else self._least(self.received_boot.excess(time, now), now)

    def above_fastest_signature(self, message: Message, now: Nanoseconds) -> Nanoseconds | None:
        """Take a signature's stamp as that of a clock that no one answers for."""
        stamp = self._stamp(message)
        return None if stamp is None else self._least(self.received_stamps.excess(stamp, now), now)

    def half_round_trip(self, _message: Message, now: Nanoseconds) -> Nanoseconds | None:
        """Return the recent travel time of any message: MANUAL_CONTROL carries no time."""
        trip = self.trips.newest(now)
        return None if trip is None else trip // 2

    def _least(self, excess: Nanoseconds | None, now: Nanoseconds) -> Nanoseconds | None:
        """Bound a message's delay behind the fastest one by the fastest one's own travel time."""
        trip = self.trips.newest(now)
        # The fastest message has travelled, too, for half of the shortest round trip.
        return excess if excess is None or trip is None else max(excess, trip // 2)

    def _unwrapped(self, message: Message) -> Nanoseconds | None:
        """Return a set-point's time as one that does not wrap after 49 days; None where it has none."""
        time = boot_ms(message)
        if time is None:
            return None
        before = 0 if self._boot is None else self._boot // MILLISECOND
        # To the nearest multiple of 2^32 ms, forwards or backwards: messages may overtake one another.
        ahead = (time - before + BOOT_WRAPS // 2) % BOOT_WRAPS - BOOT_WRAPS // 2
        self._boot = (before + ahead) * MILLISECOND
        return self._boot

    def _stamp(self, message: Message) -> Nanoseconds | None:
        return stamp_of(bytes(message.get_msgbuf())) * UNIT if self.signed else None


def _whole(now: Nanoseconds) -> Nanoseconds:
    return now // _GRAIN * _GRAIN


AgeOf: TypeAlias = Callable[[Ages, Message, Nanoseconds], Nanoseconds | None]


@dataclass(frozen=True, slots=True)
class AgeSource:
    """One way to find the age of a message."""

    name: str
    age_of: AgeOf
    timestamped: bool
    """True where it finds the age to within half a round trip; else only a lower bound."""


ROWS: Final = (
    AgeSource("the set-point's time, by TIMESYNC", Ages.by_set_point, timestamped=True),
    AgeSource("the signature's time stamp, by the stamps of answers", Ages.by_signature, timestamped=True),
    AgeSource("the set-point's time, above the fastest", Ages.above_fastest_set_point, timestamped=False),
    AgeSource(
        "the signature's time stamp, above the fastest", Ages.above_fastest_signature, timestamped=False
    ),
    AgeSource("half a round trip", Ages.half_round_trip, timestamped=False),
)
