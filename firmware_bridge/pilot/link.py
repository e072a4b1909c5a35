"""The link as the station measures it: round trip, age of the view, share of frames lost.

It sends TIMESYNC requests to the robot, as the robot does to it; an answer bounds the robot's clock from both
sides.
"""

from typing import Final

from firmware_bridge.mavlink.clock_fit import AnsweredClock
from firmware_bridge.mavlink.frames import Losses, Message, dialect
from firmware_bridge.mavlink.round_trips import RoundTrips
from firmware_bridge.units import Nanoseconds

_TIMESYNC: Final = dialect.MAVLINK_MSG_ID_TIMESYNC


class PilotLink:
    """One robot's link; instants by the station's own clock."""

    def __init__(self) -> None:
        self.clock: Final = AnsweredClock()
        """The robot's."""
        self._trips: Final = RoundTrips()
        self._losses: Final = Losses()
        self._round_trip: Nanoseconds | None = None

    @property
    def next_question(self) -> Nanoseconds:
        """Time of the next request."""
        return self._trips.due

    @property
    def lost(self) -> float | None:
        """The share of the robot's frames that did not come in the last five seconds; None before."""
        return self._losses.share

    def received(self, sequence: int, now: Nanoseconds) -> None:
        """Take note of a frame of the robot's."""
        self._losses.received(sequence, now)

    def question(self, now: Nanoseconds) -> Message:
        """Return the request that is due now."""
        requested_at = max(now, 1)
        self._trips.ask((_TIMESYNC, requested_at), now=requested_at)
        return dialect.MAVLink_timesync_message(0, requested_at)

    def answered(self, message: Message, now: Nanoseconds) -> None:
        """Take an answer; one to no open request is ignored."""
        requested_at = self._trips.answered((_TIMESYNC, message.ts1), now)
        if requested_at is not None:
            self.clock.answered(requested_at, message.tc1, now, 1)

    def round_trip(self, now: Nanoseconds) -> Nanoseconds | None:
        """Return how long it takes there and back; after a silence what it was; None before any answer."""
        newest = self._trips.newest(now)
        # After a silence the last known value is the better guess than none.
        if newest is not None:
            self._round_trip = newest
        return self._round_trip

    def measured_at(self, robots: Nanoseconds, now: Nanoseconds) -> Nanoseconds | None:
        """Return when the robot's clock showed this, by ours; None while its clock is not known."""
        shows = self.clock.shows(now)
        # The age of the reading by the robot's clock, taken off our own.
        return None if shows is None else now - (shows - robots)
