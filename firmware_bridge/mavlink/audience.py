"""The recipients: telemetry goes to stations, answers to the sender of a request.

A station is a place that a heartbeat came from, and any good frame for this robot keeps it one. Messages to
others must fit into the bytes that came from there, so that a forged address gains nothing.
"""

from collections.abc import Callable, Collection, Iterable
from typing import Final

from firmware_bridge.mavlink.frames import Message, dialect
from firmware_bridge.mavlink.schedule import Schedule
from firmware_bridge.mavlink.trust import Trust
from firmware_bridge.mavlink.voice import Voice
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

LAPSES_AFTER: Final[Nanoseconds] = 5 * SECOND
"""A station that is not received for so long is sent nothing more; heartbeats come each second."""
MOST_STATIONS: Final = 8
"""Stations beside the one in control: a further place with heartbeats waits until one of them lapses."""
MOST_PLACES: Final = 64
"""Beside stations: so many places are remembered by what they have sent; of more, the oldest is forgotten."""
LARGEST_CREDIT: Final = 1024
"""Largest credit of a place, in bytes received from it before it is answered."""
_TEXT: Final = dialect.MAVLINK_MSG_ID_STATUSTEXT
_LINK, _ASIDE = 1, 2
"""Links of signatures: a place that becomes a station receives two streams."""
ONE_END: Final = 0
"""The source on a link that has one other end; it was chosen here, and receives from the start."""


class Audience:
    """The places that frames came from; each station receives a sequence of its own, without gaps."""

    __slots__ = ("_aside", "_credits", "_numbers", "_old", "_stamp", "_stations", "_trust", "_voices")

    def __init__(
        self, system: int, component: int, trust: Trust, stamp: Callable[[Nanoseconds], int]
    ) -> None:
        """Write under these numbers, and signed where there is a key: with the `stamp` of the instant."""
        self._numbers: Final = (system, component)
        self._trust: Final = trust
        self._stamp: Final = stamp
        self._aside: Final = Voice(trust.writer(system, component, _ASIDE))
        """Speaks to those that are no stations."""
        self._voices: Final[dict[int, Voice]] = {}
        self._old: Final[set[int]] = set()
        """Of them all, those whose newest good frame was one of MAVLink 1."""
        self._stations: Final[dict[int, Nanoseconds]] = {}
        """Time of each one's newest frame."""
        self._credits: Final[dict[int, int]] = {}
        """Credit in bytes of each of the others: those received less those sent."""

    def received(self, source: int, size: int, now: Nanoseconds, *, beats: bool, old: bool = False) -> None:
        """Take note of a datagram with a good frame for this robot; `beats`: one was a heartbeat.

        `old`: it was of MAVLink 1, in which it is answered.
        """
        self._lapse(now)
        if old:
            self._old.add(source)
        else:
            self._old.discard(source)
        if source == ONE_END:
            return
        if source in self._stations or (beats and len(self._stations) < MOST_STATIONS):
            self._stations[source] = now
            self._credits.pop(source, None)
            return
        credit = self._credits.pop(source, 0) + size
        while len(self._credits) >= MOST_PLACES:
            gone = next(iter(self._credits))
            del self._credits[gone]
            self._old.discard(gone)
        self._credits[source] = min(credit, LARGEST_CREDIT)

    def answer(
        self, source: int, messages: Collection[Message], driver: int | None, now: Nanoseconds
    ) -> tuple[Packet, ...]:
        """Return answers for a place; what it has not paid for is left out."""
        if not messages:
            return ()
        stamp = self._stamp(now)
        if self.is_recipient(source, driver, now):
            return self._encoded(source, messages, stamp)
        sent: list[Packet] = []
        self._aside.mavlink_1 = source in self._old
        # What a machine waits for goes before a text for people.
        for message in sorted(messages, key=lambda one: bool(one.get_msgId() == _TEXT)):
            datagram = self._aside.frame(message, stamp)
            left = 0 if datagram is None else self._credits.get(source, 0) - len(datagram)
            if datagram is not None and left >= 0:
                self._credits[source] = left
                sent.append(Packet(OPERATOR, source, datagram))
        return tuple(sent)

    def send(self, source: int, messages: Iterable[Message], now: Nanoseconds) -> tuple[Packet, ...]:
        """Return what goes to one of `recipients`."""
        return self._encoded(source, messages, self._stamp(now))

    def recipients(self, driver: int | None, now: Nanoseconds) -> list[int]:
        """Return the places that telemetry goes to: all stations, and that of the station in control."""
        self._lapse(now)
        recipients = [ONE_END, *self._stations]
        recipients = recipients if driver is None or driver in recipients else [*recipients, driver]
        for source in self._voices.keys() - set(recipients):
            del self._voices[source]
        return recipients

    def is_recipient(self, source: int, driver: int | None, now: Nanoseconds) -> bool:
        """Return whether telemetry goes to a place."""
        self._lapse(now)
        return source in self._stations or source in (ONE_END, driver)

    def voice(self, source: int) -> Voice:
        """Return the voice for a place; settings of one that receives no telemetry do not last."""
        voice = self._voices.get(source)
        if voice is None:
            voice = self._voices[source] = Voice(self._trust.writer(*self._numbers, _LINK))
        return voice

    def schedule(self, source: int) -> Schedule | None:
        """Return the schedule of a place; None where it has requested no intervals."""
        voice = self._voices.get(source)
        return None if voice is None else voice.schedule

    def change(
        self, source: int, number: int, period: Nanoseconds | None, usual: Schedule, now: Nanoseconds
    ) -> None:
        """Send a place a message so often; None: as often as all, by the schedule that is `usual`."""
        voice = self.voice(source)
        if voice.schedule is None:
            voice.schedule = usual.copy()
        voice.schedule.change(number, period, now)

    def follow(self, number: int, period: Nanoseconds, now: Nanoseconds) -> None:
        """Set a message's period for the places without an interval of their own for it."""
        for voice in self._voices.values():
            if voice.schedule is not None:
                voice.schedule.follow(number, period, now)

    @property
    def next_due(self) -> Nanoseconds:
        """The instant at which a message is due for a place with intervals of its own."""
        own = [voice.schedule for voice in self._voices.values() if voice.schedule is not None]
        return min((schedule.next_due for schedule in own), default=NEVER)

    def _encoded(self, source: int, messages: Iterable[Message], stamp: int) -> tuple[Packet, ...]:
        voice = self.voice(source)
        voice.mavlink_1 = source in self._old
        frames = [voice.frame(message, stamp) for message in messages]
        return tuple(Packet(OPERATOR, source, frame) for frame in frames if frame is not None)

    def _lapse(self, now: Nanoseconds) -> None:
        gone = [source for source, at in self._stations.items() if now - at >= LAPSES_AFTER]
        for source in gone:
            del self._stations[source]
            self._old.discard(source)
