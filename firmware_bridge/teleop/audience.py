"""Who is told: telemetry goes to stations, answers to who asked.

A station is a place that a heartbeat came from, and any good frame for this robot keeps it one. What goes to
others must fit into the bytes that came from there, so that a forged address gains nothing.
"""

from collections.abc import Callable, Iterable
from typing import Final

from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.teleop.mavlink import Codec, Message, dialect
from firmware_bridge.teleop.trust import Trust
from firmware_bridge.units import SECOND, Nanoseconds

LAPSES_AFTER: Final[Nanoseconds] = 5 * SECOND
"""A station that is not heard for so long is told no more; heartbeats come each second."""
MOST_STATIONS: Final = 8
"""Beside who drives: a place more that sends heartbeats waits until one of them lapses."""
MOST_STRANGERS: Final = 64
LARGEST_CREDIT: Final = 1024
"""Bytes that a place may have sent before it is answered."""
_TEXT: Final = dialect.MAVLINK_MSG_ID_STATUSTEXT
_LINK, _ASIDE = 1, 2
"""Links of signatures: who is a station now and was none before hears two streams."""
ONE_END: Final = 0
"""The source on a link that has one other end; it was chosen here, and is told from the start."""


class Audience:
    """The places that frames came from; each station hears a sequence of its own, without gaps."""

    __slots__ = ("_aside", "_codecs", "_credits", "_numbers", "_stamp", "_stations", "_trust")

    def __init__(
        self, system: int, component: int, trust: Trust, stamp: Callable[[Nanoseconds], int]
    ) -> None:
        """Write under these numbers, and signed where there is a key: with the `stamp` of the instant."""
        self._numbers: Final = (system, component)
        self._trust: Final = trust
        self._stamp: Final = stamp
        self._aside: Final = trust.writer(system, component, _ASIDE)
        """Writes to those that are no stations."""
        self._codecs: Final[dict[int, Codec]] = {}
        self._stations: Final[dict[int, Nanoseconds]] = {}
        """When each of them was heard last."""
        self._credits: Final[dict[int, int]] = {}
        """Bytes that came from each of the others, less those that went there."""

    def heard(self, source: int, size: int, now: Nanoseconds, *, beats: bool) -> None:
        """Take note of a datagram with a good frame for this robot; `beats`: one was a heartbeat."""
        if source == ONE_END:
            return
        self._lapse(now)
        if source in self._stations or (beats and len(self._stations) < MOST_STATIONS):
            self._stations[source] = now
            self._credits.pop(source, None)
            return
        credit = self._credits.pop(source, 0) + size
        while len(self._credits) >= MOST_STRANGERS:
            del self._credits[next(iter(self._credits))]
        self._credits[source] = min(credit, LARGEST_CREDIT)

    def answer(
        self, source: int, messages: Iterable[Message], driver: int | None, now: Nanoseconds
    ) -> tuple[Packet, ...]:
        """Return answers for a place; what it has not paid for is left out."""
        stamp = self._stamp(now)
        if source in self._told(driver, now):
            codec = self._codec(source)
            return tuple(Packet(OPERATOR, source, codec.encode(message, stamp)) for message in messages)
        sent: list[Packet] = []
        # What a machine waits for goes before a text for people.
        for message in sorted(messages, key=lambda one: bool(one.get_msgId() == _TEXT)):
            datagram = self._aside.encode(message, stamp)
            left = self._credits.get(source, 0) - len(datagram)
            if left >= 0:
                self._credits[source] = left
                sent.append(Packet(OPERATOR, source, datagram))
        return tuple(sent)

    def tell(self, messages: Iterable[Message], driver: int | None, now: Nanoseconds) -> tuple[Packet, ...]:
        """Return what goes to every station, and to the place of who drives."""
        told, stamp = self._told(driver, now), self._stamp(now)
        codecs = [(source, self._codec(source)) for source in told]
        for source in self._codecs.keys() - set(told):
            del self._codecs[source]
        return tuple(
            Packet(OPERATOR, source, codec.encode(message, stamp))
            for message in messages
            for source, codec in codecs
        )

    def _told(self, driver: int | None, now: Nanoseconds) -> list[int]:
        self._lapse(now)
        told = [ONE_END, *self._stations]
        return told if driver is None or driver in told else [*told, driver]

    def _codec(self, source: int) -> Codec:
        codec = self._codecs.get(source)
        if codec is None:
            codec = self._codecs[source] = self._trust.writer(*self._numbers, _LINK)
        return codec

    def _lapse(self, now: Nanoseconds) -> None:
        gone = [source for source, at in self._stations.items() if now - at >= LAPSES_AFTER]
        for source in gone:
            del self._stations[source]
