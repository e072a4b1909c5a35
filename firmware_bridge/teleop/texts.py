"""Texts for operators: of interlocks that begin and end, and of the link to the station in control.

The link's figures are rows: each is reported when it gets bad, and when it is good again.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

from firmware_bridge.intent import AgeLimit
from firmware_bridge.mavlink.age import Ages
from firmware_bridge.mavlink.frames import Message
from firmware_bridge.mavlink.texts import Speaker
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.safety.snapshot import ActiveInterlock, Facts
from firmware_bridge.units import SECOND, Nanoseconds, to_seconds

REPORTED_AFTER: Final[Nanoseconds] = 3 * SECOND
"""Time for a first answer of a station that answers at all."""


class LinkState(NamedTuple):
    """State of the link now."""

    ages: Ages
    limit: AgeLimit
    timestamped: bool
    """True where the newest motion command's age is known."""
    now: Nanoseconds


@dataclass(frozen=True, slots=True)
class LinkFigure:
    """One figure, None while it is not known; between its bounds nothing changes."""

    reads: Callable[[LinkState], float | None]
    bad_from: float
    good_below: float
    bad: str
    """A text with the figure in it."""
    good: str


def _round_trip(link: LinkState) -> float | None:
    """Return the round trip as a share of a command's age limit."""
    trip = link.ages.trips.newest(link.now)
    return None if trip is None else trip / link.limit.most


def _lost(link: LinkState) -> float | None:
    return link.ages.losses.share


def _differs(link: LinkState) -> float | None:
    """Return the disagreement of a station's clocks, as a share of a command's age limit."""
    return link.ages.differs / link.limit.most


def _not_timestamped(link: LinkState) -> float | None:
    requested_at = link.ages.trips.began_at
    reported = requested_at is not None and link.now - requested_at >= REPORTED_AFTER
    return float(not link.timestamped) if reported else None


ROWS: Final = (
    LinkFigure(
        _round_trip, 1.0, 0.75, "link: round trip {trip:.2f} s", "link: round trip {trip:.2f} s, good again"
    ),
    LinkFigure(
        _lost,
        0.1,
        0.05,
        "link: {share:.0%} of this station's frames are lost",
        "link: frames come again",
    ),
    LinkFigure(
        _differs,
        1.0,
        0.5,
        "link: this station's clocks disagree by {trip:.2f} s: its messages count as old as the oldest",
        "link: this station's clocks agree again",
    ),
    LinkFigure(
        _not_timestamped,
        1.0,
        1.0,
        "link: the age of this station's commands is unknown, only their loss is noticed",
        "link: the age of this station's commands is known",
    ),
)


class Quality:
    """The rows that are bad; one for each station in control."""

    __slots__ = ("_bad",)

    def __init__(self) -> None:
        self._bad: Final[set[int]] = set()

    def changes(self, link: LinkState) -> list[tuple[Severity, str]]:
        """Return the changes, as text."""
        reported: list[tuple[Severity, str]] = []
        for place, row in enumerate(ROWS):
            value = row.reads(link)
            if value is None:
                continue
            if place not in self._bad and value >= row.bad_from:
                self._bad.add(place)
                reported.append((Severity.WARNING, _text(row.bad, value, link)))
            elif place in self._bad and value < row.good_below:
                self._bad.discard(place)
                reported.append((Severity.INFO, _text(row.good, value, link)))
        return reported


def _text(text: str, value: float, link: LinkState) -> str:
    return text.format(share=value, trip=value * to_seconds(link.limit.most))


class InterlockTexts:
    """Reports of active and cleared interlocks; of one that comes and goes, three times in two seconds.

    Information is sent once: a stick passes the acceleration limit again and again in normal driving.
    """

    MOST: Final = 3

    def __init__(self, speaker: Speaker) -> None:
        self._speaker: Final = speaker
        self._shown: Final[dict[tuple[str, str], Severity]] = {}
        """The interlock events reported as active."""
        self._began: Final[dict[tuple[str, str], list[Nanoseconds]]] = {}
        """Times of the events' begins reported lately."""
        self._informed: Final[set[tuple[str, str]]] = set()
        """Past events that were information."""

    def due(self, events: tuple[ActiveInterlock, ...], now: Nanoseconds) -> list[Message]:
        """Return texts of what is not as reported last."""
        current = {event.text_key: event for event in events if event.text_key not in self._informed}
        if current.keys() == self._shown.keys():
            return []
        messages: list[Message] = []
        active = {name for name, _ in current}
        for key in [one for one in self._shown if one not in current]:
            if self._shown.pop(key) is Severity.INFO:
                self._informed.add(key)
            elif key[0] not in active:
                messages += self._speaker.say(Severity.INFO, f"cleared: {key[0]}")
        for key, event in current.items():
            lately = [at for at in self._began.get(key, ()) if now - at < Speaker.QUIET]
            if key not in self._shown and len(lately) < self.MOST:
                self._shown[key] = event.interlock.severity
                self._began[key] = [*lately, now]
                remedy = f"; {event.remedy}" if event.remedy else ""
                messages += self._speaker.say(event.interlock.severity, f"{event.reason}{remedy}")
        return messages


class Texts:
    """Texts for the operators: for all of them with the next report, or for one with its answer."""

    MOST_UNSENT: Final = 8
    """Control that changes all the time must not flood those who only watch."""

    def __init__(self, robot: AnyRobot) -> None:
        self.speaker: Final = Speaker()
        self.unsent: list[Message] = []
        """Messages about control, sent with the next report, beside the answers."""
        self._interlocks: Final = InterlockTexts(self.speaker)
        self._called: Final = {axis.name: axis.called for axis in robot.axes}
        self._faults: Final[dict[str, str]] = {}
        """The fault of each axis that was reported last, by the axis' name."""

    def report(self, severity: Severity, text: str) -> None:
        """Queue a text for the next report, unless the queue is full."""
        if len(self.unsent) < self.MOST_UNSENT:
            self.unsent += self.speaker.say(severity, text)

    def sometimes(self, key: str, text: str, now: Nanoseconds) -> bool:
        """Queue a warning, but not at the rate of a joystick; return whether it is queued."""
        given = self.speaker.say_sometimes(key, text, now)
        self.unsent += given
        return bool(given)

    def due(self, facts: Facts, events: tuple[ActiveInterlock, ...], now: Nanoseconds) -> list[Message]:
        """Return what is queued, what began or ended of the interlocks, and changes of the axes' faults."""
        messages = self.unsent + self._interlocks.due(events, now)
        self.unsent = []
        for axis in facts.axes.values():
            before = self._faults.get(axis.axis, "")
            if axis.fault == before:
                continue
            self._faults[axis.axis] = axis.fault
            called = self._called[axis.axis]
            if axis.fault:
                messages += self.speaker.say(Severity.CRITICAL, f"{called}: fault {axis.fault}")
            else:
                messages += self.speaker.say(Severity.INFO, f"{called}: fault cleared")
        return messages
