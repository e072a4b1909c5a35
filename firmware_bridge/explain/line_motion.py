"""Motors of a board: commands, and the counts of their encoders.

Encoder and motor are taken to have the same number, as the bridge has them.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf
from typing import Final

from firmware_bridge.explain import line_kinds as kinds
from firmware_bridge.explain.incident import Evidence, IncidentKind, Incidents, Report
from firmware_bridge.explain.line_texts import COMMANDS, COUNTS, NUMBERED, OF_ENCODER, READS, WAYS, ZEROED
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

WINDOW: Final[Nanoseconds] = 150 * MILLISECOND
"""Counts are compared with commands over this time."""
STEADY: Final[Nanoseconds] = 400 * MILLISECOND
"""A command has to be above the threshold in one direction for so long before it counts."""
STALLED: Final[Nanoseconds] = 500 * MILLISECOND
"""A motor that is commanded for so long has to turn."""
MISSED: Final = 50
"""... or one that should have counted so far, by the counts for its commands before: a bridge that notices
it stops the motor within a tenth of a second."""
NOT_LESS: Final = 0.95
SLOWER: Final = 0.6
"""A motor whose command is not less, and whose speed is this share of before, falls behind."""
BACKWARDS: Final = 30
"""Counts against the command that are no vibration."""
TURNS: Final = 1 << 16
"""Counts of 16 bits go on at the other end."""
UNCHANGED: Final = 0.3
"""Change of a command from one window to the next, within which windows are compared."""
SHARE: Final = 0.3
"""Of the greatest command that was seen: smaller ones may not overcome friction."""
LEARNT: Final = 4
"""Windows after which direction and ratio of a motor are known."""
FEWER: Final = 0.5
MORE: Final = 1.9
"""Of counts for a command, compared with before."""
AMONG: Final = 2
"""Of more motors than these one can be the odd one."""
JUMPED: Final = 20.0
"""Times the fastest movement that was seen."""
ZERO: Final = 50
"""Counts that are at 0 at once from beyond this number begin again."""
_TURNING: Final = (kinds.NO_COUNTS, kinds.ALL_STOPPED)


@dataclass(slots=True)
class Motor:
    """What is known of one motor."""

    number: int
    size: float = 0.0
    way: int = 1
    since: Nanoseconds = 0
    """From when on the command has this sign and is above the threshold."""
    count: int | None = None
    counted_at: Nanoseconds = 0
    changed_at: Nanoseconds = 0
    window_at: Nanoseconds = 0
    window_count: int = 0
    commanded: float = 0.0
    """Mean of the command in the window, summed over time."""
    command_at: Nanoseconds = 0
    mean: float = 0.0
    """Of the command in the window before."""
    good_mean: float = 0.0
    good_rate: float = 0.0
    """Command, and counts a second, of the last window that was as usual."""
    ratios: deque[float] = field(default_factory=lambda: deque(maxlen=24))
    fastest: float = 0.0
    streak: dict[str, int] = field(default_factory=dict)
    ever: bool = False

    @property
    def command(self) -> float:
        """Size and direction of the command."""
        return self.size * self.way

    @property
    def usual(self) -> float | None:
        """Counts a second for a command of 1; None while it is not known."""
        if len(self.ratios) < LEARNT:
            return None
        return sorted(self.ratios)[len(self.ratios) // 2]


def commands_of(text: str) -> Iterator[tuple[int, float | None, int | None]]:
    """Yield motor, size and direction that a request commands; None for what it leaves as it is."""
    for pattern in COMMANDS:
        found = pattern.match(text)
        if found is not None:
            groups = {key: value for key, value in found.groupdict().items() if value is not None}
            if "each" in groups:
                for place, value in enumerate(map(int, groups["each"].split()), start=1):
                    yield place, float(abs(value)), -1 if value < 0 else 1
                return
            yield _one(groups)


def _one(groups: dict[str, str]) -> tuple[int, float | None, int | None]:
    motor = int(groups["motor"]) if "motor" in groups else int(groups["zero"]) + 1
    if "stop" in groups:
        return motor, 0.0, None
    pin, level = groups.get("pin"), int(groups.get("level", 0))
    if pin is not None:
        sizes = {"pwm": float(level)}
        ways = {"in1": 1, "in2": -1}
        return motor, sizes.get(pin), ways.get(pin) if level else None
    way = groups.get("way")
    return (
        motor,
        float(groups["size"]) if "size" in groups else None,
        None if way is None else WAYS.get(way, 0),
    )


def counts_of(request: str, value: str, answer: str) -> Iterator[tuple[int, int]]:
    """Yield encoder, counted from 1, and count of an answer."""
    if READS.match(request) is None:
        yield from ((int(encoder) + 1, int(count)) for count, encoder in NUMBERED.findall(answer))
        return
    for pattern in COUNTS:
        found = pattern.match(answer)
        if found is None:
            continue
        groups = found.groupdict()
        encoder = OF_ENCODER.match(value)
        numbers = list(map(int, (groups.get("each") or groups.get("count") or "").split()))
        if encoder is not None:
            yield int(encoder[1]) + 1, numbers[0]
        else:
            yield from enumerate(numbers, start=1)
        return


@dataclass(frozen=True, slots=True)
class _Window:
    """Command and counts of one motor over a short time."""

    mean: float
    """Of the command."""
    rate: float
    """Counts a second."""
    before: float
    """Mean of the command in the window before."""

    @property
    def steady(self) -> bool:
        """Return whether the command is as before: else a motor gains or loses speed."""
        return abs(self.mean - self.before) <= UNCHANGED * abs(self.before)

    def shows(self, motor: Motor, moved: int) -> bool:
        """Return whether its counts can be compared with those before."""
        backwards = self.rate * self.mean * (motor.usual or 0.0) < 0 and abs(moved) > BACKWARDS
        no_less = abs(self.mean) >= NOT_LESS * abs(motor.good_mean)
        weaker = no_less and abs(self.rate) < SLOWER * abs(motor.good_rate)
        return self.steady or backwards or weaker


@dataclass(frozen=True, slots=True)
class _Judged:
    """An incident that counts for a command show, as a share of those before."""

    kind: IncidentKind
    least: float
    most: float
    windows: int
    """Number of windows that have to show it, one after the other."""
    what: str

    def shows(self, share: float) -> bool:
        """Return whether this share is one."""
        return self.least <= share < self.most


_JUDGED: Final = (
    _Judged(kinds.REVERSED, -inf, -0.2, 1, "its encoder counts against the command"),
    _Judged(kinds.FEWER_COUNTS, -0.2, FEWER, 2, "its encoder counts {:.0%} of before"),
    _Judged(kinds.MORE_COUNTS, MORE, inf, 2, "its encoder counts {:.0%} of before"),
)


class Motion:
    """The motors of one board."""

    def __init__(self, incidents: Incidents) -> None:
        self._incidents = incidents
        self._motors: dict[int, Motor] = {}
        self._most = 0.0
        self.restarted = False
        """Counts have gone to 0 by themselves since it was last looked at."""

    def requested(self, at: Nanoseconds, text: str) -> None:
        """Take a request."""
        if ZEROED.match(text):
            self.forget()
            return
        for number, size, way in commands_of(text):
            motor = self._motors.setdefault(number, Motor(number))
            self._spent(motor, at)
            before = motor.command
            motor.size = motor.size if size is None else size
            motor.way = motor.way if way is None else way
            self._most = max(self._most, motor.size)
            if not self._driven(motor) or before * motor.command <= 0:
                self._begin(motor, at)

    def forget(self) -> None:
        """Forget the counts: they begin at another number."""
        for motor in self._motors.values():
            motor.count = None

    def _driven(self, motor: Motor) -> bool:
        return motor.size >= SHARE * self._most and motor.way != 0 and motor.size > 0

    def _begin(self, motor: Motor, at: Nanoseconds) -> None:
        motor.since = motor.window_at = motor.changed_at = at
        motor.commanded, motor.command_at = 0.0, at
        motor.window_count = motor.count or 0
        motor.streak.clear()

    def _spent(self, motor: Motor, at: Nanoseconds) -> None:
        motor.commanded += motor.command * to_seconds(at - motor.command_at)
        motor.command_at = at

    def counted(self, at: Nanoseconds, number: int, count: int, shown: Evidence) -> None:
        """Take the count of an encoder."""
        motor = self._motors.setdefault(number, Motor(number))
        before, elapsed = motor.count, at - motor.counted_at
        if before is not None and abs(abs(count - before) - TURNS) < TURNS // 8:
            self._begin(motor, at)
            before = count
            motor.window_count = count
        motor.count, motor.counted_at = count, at
        if before is None:
            self._begin(motor, at)
            return
        if self._jumped(motor, at, count - before, elapsed, shown):
            self._begin(motor, at)
            return
        if count != before:
            motor.changed_at, motor.ever = at, True
            self._incidents.close(_TURNING, at, number, "it counts again")
            self._incidents.close((kinds.ALL_STOPPED,), at, None, "it counts again")
        self._stalled(motor, at, shown)
        if at - motor.window_at >= WINDOW:
            self._window(motor, at, shown)

    def _jumped(
        self, motor: Motor, at: Nanoseconds, change: int, elapsed: Nanoseconds, shown: Evidence
    ) -> bool:
        speed = abs(change) / max(to_seconds(elapsed), 0.01)
        before = (motor.count or 0) - change
        if abs(before) > ZERO and abs(motor.count or 0) * 10 < abs(before) and speed > 3 * motor.fastest:
            self.restarted = True
            return True
        if len(motor.ratios) >= LEARNT and motor.fastest and speed > JUMPED * motor.fastest:
            self._open(kinds.JUMP, at, motor, f"its count jumps by {change}", shown)
            self._incidents.close((kinds.JUMP,), at, motor.number, "")
            return True
        motor.fastest = max(motor.fastest, speed)
        return False

    def _stalled(self, motor: Motor, at: Nanoseconds, shown: Evidence) -> None:
        if not self._still(motor, at):
            return
        driven = [one for one in self._motors.values() if self._driven(one) and one.count is not None]
        since = max(motor.changed_at, motor.since)
        shortly = (at - since) // MILLISECOND
        if len(driven) > 1 and all(one is motor or self._still(one, one.counted_at) for one in driven):
            what = f"{len(driven)} motors are commanded, and no encoder has counted for {shortly} ms"
            self._incidents.withdraw(kinds.NO_COUNTS, since)
            self._incidents.open(kinds.ALL_STOPPED, since, Report(what=what, evidence=shown))
        elif not self._incidents.is_open(kinds.ALL_STOPPED):
            what = f"commanded {motor.command:g}, and its encoder has not counted for {shortly} ms"
            if not self._incidents.is_open(kinds.NO_COUNTS, motor.number):
                self._open(kinds.NO_COUNTS, since, motor, what, shown)

    def _still(self, motor: Motor, at: Nanoseconds) -> bool:
        """Return whether a motor should have turned since its count has changed."""
        if not self._driven(motor):
            return False
        since = max(motor.changed_at, motor.since)
        if motor.usual is not None and since - motor.since >= STEADY:
            return abs(motor.usual * motor.command) * to_seconds(at - since) > MISSED
        return at - since > (STALLED if motor.ever else 2 * STALLED)

    def _window(self, motor: Motor, at: Nanoseconds, shown: Evidence) -> None:
        """Compare counts with commands since the window before."""
        self._spent(motor, at)
        elapsed = to_seconds(at - motor.window_at)
        commanded, moved = motor.commanded, (motor.count or 0) - motor.window_count
        window = _Window(commanded / elapsed, moved / elapsed, motor.mean)
        driven = motor.window_at - motor.since >= STEADY and self._driven(motor)
        motor.mean = window.mean
        motor.window_at, motor.window_count, motor.commanded = at, motor.count or 0, 0.0
        if not driven or not commanded or not moved:
            return
        if motor.usual is not None:
            if window.shows(motor, moved):
                self._judge(motor, at, window, shown)
        elif window.steady:
            motor.ratios.append(moved / commanded)
            self._against_others(at, shown)

    def _judge(self, motor: Motor, at: Nanoseconds, window: _Window, shown: Evidence) -> None:
        share = window.rate / window.mean / (motor.usual or 1.0)
        for row in _JUDGED:
            streak = motor.streak[row.kind.name] = (motor.streak.get(row.kind.name, 0) + 1) * row.shows(share)
            if not streak:
                self._incidents.close((row.kind,), at, motor.number, "as before")
            elif streak >= row.windows and not self._incidents.is_open(row.kind, motor.number):
                self._open(row.kind, at - row.windows * WINDOW, motor, row.what.format(share), shown)
                if row.kind is kinds.FEWER_COUNTS:
                    self._one_alone(motor)
        if FEWER <= share <= MORE:
            motor.ratios.append(window.rate / window.mean)
            motor.good_mean, motor.good_rate = window.mean, window.rate

    def _one_alone(self, motor: Motor) -> None:
        """Put the causes of a motor that falls behind by itself, or with others."""
        kind = kinds.FEWER_COUNTS
        behind = [one for one in self._motors.values() if one.streak.get(kind.name)]
        for one in behind:
            incident = self._incidents.recent(kind, motor.window_at - STALLED, one.number)
            if incident is not None:
                incident.causes = kinds.ONE_BEHIND if len(behind) == 1 else kind.causes

    def _against_others(self, at: Nanoseconds, shown: Evidence) -> None:
        """Compare the direction of each motor with those of all others, as soon as they are known."""
        known = [one for one in self._motors.values() if one.usual is not None]
        for motor in known if len(known) > AMONG else ():
            others = [one.usual or 0.0 for one in known if one is not motor]
            if all((motor.usual or 0.0) * other < 0 for other in others):
                what = "its encoder counts against the command, those of the others with it"
                if not self._incidents.is_open(kinds.REVERSED, motor.number):
                    self._open(kinds.REVERSED, at, motor, what, shown)

    def _open(self, kind: IncidentKind, at: Nanoseconds, motor: Motor, what: str, shown: Evidence) -> None:
        self._incidents.open(kind, at, Report(what=what, evidence=shown, node=motor.number))
