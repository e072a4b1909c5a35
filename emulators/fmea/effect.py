"""The effect of one failure in one state: its detection, and the robot's motion by the plant's truth.

The same state without the failure is run beside it: the difference is the failure's.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np

from emulators.bench.columns import SAMPLE_EVERY, Floats
from emulators.bench.log import LogEntry, Subject
from emulators.bench.records import InterlockEvent
from emulators.testing.rig import VirtualRig
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds, from_seconds

LASTS_S: Final = 2.0
"""Duration of a failure that has an end."""
NEUTRAL_AFTER_S: Final = 1.0
"""Time for which the operator goes on as before; then the stick goes to neutral, while the failure lasts."""
WATCHED_S: Final = 3.5
"""Time of observation: the end of the failure, and the robot's motion then."""
STANDSTILL_WITHIN_S: Final = 12.0
"""... and so long where it still moves then: a robot that moves after it counts as never stopping."""
ASIDE: Final[Mapping[str, float]] = {"m": 0.02, "rad": 0.05}
"""Limits of a deviation from the run without the failure. Assumed; the first is what docs/safety.md allows a
robot at standstill without power."""
SHARE: Final = 0.05
"""... and this share of the distance without the failure: tolerance of a robot without a fault. Assumed."""
STILL: Final[Mapping[str, float]] = {"m": 0.001, "rad": 0.003}
"""Limits of motion below which a robot is at standstill."""
STANDSTILL_S: Final = 0.3
"""... for at least so long before the end."""


EACH_MS: Final = SAMPLE_EVERY / MILLISECOND
LATE_MS: Final = 500.0
"""Limit from which an unreported deviation counts as noticed late. Assumed."""


class Assessment(StrEnum):
    """Assessment of a cell."""

    NOTICED = "noticed"
    """An interlock is active."""
    REPORTED = "reported"
    """The operator was informed, and no interlock is active."""
    TOLERATED = "tolerated"
    """The failure was not reported, and the robot does what it would do without it."""
    STOPPED = "stopped"
    """The failure was not reported, and the robot came to standstill where it would have moved on."""
    LATE = "NOTICED LATE"
    """The failure was noticed when the robot had deviated for a while."""
    NOT_NOTICED = "NOT NOTICED"
    """The failure was not reported, and the robot deviates; or it never stops, reported or not."""


@dataclass(frozen=True, slots=True)
class Course:
    """Record of a run from one instant on."""

    places: Mapping[str, Floats]
    """The plant's places, in m and rad, by the columns' names, every 10 ms."""
    units: Mapping[str, str]
    interlock_events: tuple[InterlockEvent, ...]
    """Interlock events that began since."""
    texts: tuple[LogEntry, ...]
    """Texts that the operator has received since."""
    began: Nanoseconds
    ends: Nanoseconds = NEVER
    """End of the failure: a report from then on comes of its end."""


@dataclass(frozen=True, slots=True)
class Effect:
    """Effect of one failure in one state."""

    verdict: Assessment
    noticed_by: str
    """The first active interlock, or the first text."""
    after_ms: float | None
    standstill_after_ms: float | None
    """Time of the final standstill, counted from the failure; None where it still moves at the end."""
    goes_m: float
    """The largest distance of any quantity in m from its place at the failure."""
    turns_rad: float
    aside: float
    """Deviation from the run without the failure, as a share of the limit of a deviation."""


def watched(rig: VirtualRig, lasts_s: float | None = None) -> Course:
    """Run on, and return what is seen; the stick goes to neutral on the way."""
    began, first = rig.bench.world.now, len(rig.bench.samples)
    rig.runs(NEUTRAL_AFTER_S)
    rig.operator.returns_to_neutral()
    rig.runs(WATCHED_S - NEUTRAL_AFTER_S)
    units = {column.name: column.unit for column in rig.bench_setup.columns if column.plant}
    while (places := _places(rig, units, first)) and _standstill_after(places, units) is None:
        if rig.bench.world.now - began >= from_seconds(STANDSTILL_WITHIN_S):
            break
        rig.runs(STANDSTILL_S)
    reported = (entry for entry in rig.operator.diary if entry.at >= began and entry.kind is Subject.REPORTED)
    events = tuple(event for event in rig.interlock_history if event.began >= began)
    ends = NEVER if lasts_s is None else began + from_seconds(lasts_s)
    return Course(places, units, events, tuple(reported), began, ends)


def _places(rig: VirtualRig, units: Mapping[str, str], first: int) -> dict[str, Floats]:
    samples = rig.bench.samples
    wanted = (name for name, unit in units.items() if unit in ASIDE)
    return {name: np.asarray(samples.column(name)[first:]) for name in wanted}


def effect(well: Course, ill: Course) -> Effect:
    """Compare what was seen with the failure and without it."""
    known = {event.name for event in well.interlock_events}
    events = [event for event in ill.interlock_events if event.name not in known and event.began < ill.ends]
    # What the operator reads without the failure, too, is no report of it.
    usual = {entry.text for entry in well.texts}
    texts = [entry for entry in ill.texts if entry.text not in usual and entry.at < ill.ends]
    # The quantity that deviates most decides: m and rad are comparable as shares of their limits.
    shares = np.max([_share(ill, well, name) for name in well.places], axis=0)
    other = np.flatnonzero(shares > 1.0)
    moved_ms = _moved_until(ill.places, ill.units) * EACH_MS
    by, at, verdict = "", None, Assessment.STOPPED if other.size else Assessment.TOLERATED
    if events:
        by, at, verdict = events[0].name, events[0].began, Assessment.NOTICED
    elif texts:
        by, at, verdict = texts[0].text, texts[0].at, Assessment.REPORTED
    first = min(
        (at for at in (*(event.began for event in events), *(text.at for text in texts))), default=None
    )
    after_ms = None if at is None else (at - ill.began) / MILLISECOND
    noticed_ms = None if first is None else (first - ill.began) / MILLISECOND
    if other.size:
        # Who stands does no harm, and need not say why.
        due_ms = float(other[0]) * EACH_MS + LATE_MS
        if moved_ms > due_ms and (noticed_ms is None or noticed_ms > due_ms):
            verdict = Assessment.NOT_NOTICED if noticed_ms is None else Assessment.LATE
    standstill = _standstill_after(ill.places, ill.units)
    # A robot that never stops is worse than any report makes up for.
    if standstill is None and _standstill_after(well.places, well.units) is not None:
        verdict = Assessment.NOT_NOTICED
    return Effect(
        verdict,
        by,
        after_ms,
        standstill_after_ms=standstill,
        goes_m=_furthest(ill, "m"),
        turns_rad=_furthest(ill, "rad"),
        aside=float(np.max(shares)),
    )


def _standstill_after(places: Mapping[str, Floats], units: Mapping[str, str]) -> float | None:
    """Return after how many ms it stood for good; None where it still moves at the end."""
    moved_ms = _moved_until(places, units) * EACH_MS
    length = len(next(iter(places.values()))) * EACH_MS
    return moved_ms if moved_ms < length - 1_000.0 * STANDSTILL_S else None


def _share(ill: Course, well: Course, name: str) -> Floats:
    """Return how far one place is from where it would be, as a share of what counts as something else."""
    # The run that does not stop is watched for longer.
    length = min(len(well.places[name]), len(ill.places[name]))
    there, here = well.places[name][:length], ill.places[name][:length]
    share: Floats = np.abs(here - there) / (ASIDE[ill.units[name]] + SHARE * np.abs(there - there[0]))
    return share


def _furthest(course: Course, unit: str) -> float:
    found = [np.max(np.abs(it - it[0])) for name, it in course.places.items() if course.units[name] == unit]
    return float(max(found, default=0.0))


def _moved_until(places: Mapping[str, Floats], units: Mapping[str, str]) -> int:
    """Return the first of the samples from which on it is where it is at the end."""
    last = 0
    for name, it in places.items():
        moves = np.flatnonzero(np.abs(it - it[-1]) > STILL[units[name]])
        last = max(last, int(moves[-1]) + 1 if moves.size else 0)
    return last
