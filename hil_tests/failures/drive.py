"""Drive of a robot into one cause of a stop; the result is measured by the plant's truth."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

from emulators.epos2.drive import Epos2
from emulators.testing.rig import STEP_S, VirtualRig
from firmware_bridge.bridge.stops import Progress
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.objects import ERROR_HISTORY_COUNT
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.units import MILLISECOND
from hil_tests.failures.causes import (
    COMMON,
    HIT,
    KILLED,
    LINE_CUT,
    PHASES_MS,
    REQUESTED,
    STRAIGHT,
    Cause,
    Fault,
    Motion,
)
from hil_tests.failures.kept import Kept
from hil_tests.failures.rars import FAILS
from hil_tests.failures.temporary import TEMPORARY
from hil_tests.safety.driving import ARM, SPEEDS, robot_of

CAUSES: Final = {cause.name: cause for cause in (*REQUESTED, *COMMON, *FAILS, *TEMPORARY)}
MOVES_S: Final = 2.0
WATCHED_S: Final = 12.0
STILL_S: Final = 3.0
"""A robot that has not moved for so long has come to rest: no step of a stop takes longer."""
SLOWER_MPS: Final = 0.005
TURNS_AT_M: Final = 0.15
"""Distance in m at which turning counts as motion: ROME's wheels."""
LOOKS: Final = 10
"""Samples over which motion is the mean where there are steppers: their rotors swing with each step."""
AGAIN: Final = 0.5
"""Speed of the drive afterwards, as a share of the earlier one."""
NO_ONE: Final = "no one"
ALONE: Final = "the devices by themselves"


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of one cause, begun in one way, by the plant's truth."""

    cause: str
    line: str
    motion: str
    phase_ms: int
    way_mm: int
    """Largest distance of base, tool or lift until standstill, or until the end of the look."""
    rest_ms: int
    """Time of standstill; -1 where it never came."""
    noticed_ms: int | None
    """Until the first of the interlocks that notice it; None where none did."""
    by: str
    """Name of what stopped it: an interlock, or the devices."""

    @property
    def case(self) -> "Case":
        """Its case, as it was begun."""
        cause = CAUSES[self.cause]
        motion = next(one for one in (STRAIGHT, *cause.worst_of) if one.name == self.motion)
        return Case(cause, self.line, motion, self.phase_ms)


KEPT: Final = Kept(Outcome, "outcomes")


class Case(NamedTuple):
    """One cause, begun in one way."""

    cause: Cause
    line: str
    motion: Motion
    phase_ms: int = 0

    @property
    def place(self) -> tuple[int, str, bool, bool]:
        """Its place in the file; of cases with the same place the worst is kept."""
        straight = self.motion is STRAIGHT
        return list(CAUSES).index(self.cause.name), self.line, straight, self.motion.lifts


class Found(NamedTuple):
    """The result, the active interlocks, the drives' error codes, and the speed of a drive afterwards."""

    outcome: Outcome
    interlock_events: frozenset[str]
    codes: dict[str, tuple[int, ...]]
    again: float
    """The share of the speed it had; 0 where no one drove it again."""


def cases(cause: Cause) -> Iterator[Case]:
    """Yield every way to begin it."""
    for line in cause.lines:
        yield Case(cause, line, STRAIGHT)
    for motion in cause.worst_of:
        for line in cause.on:
            for phase_ms in PHASES_MS:
                yield Case(cause, line, motion, phase_ms)


@lru_cache(maxsize=3)
def _moving(line: str, motion: str) -> VirtualRig:
    """Return a robot that moves so; it is driven there once, and taken back there."""
    rig = VirtualRig(robot_of(line))
    rig.arms()
    steps = next(one.steps for one in (STRAIGHT, *KILLED.worst_of) if one.name == motion)
    if steps:
        rig.operator.does(**steps)
    else:
        _ahead(rig, 1.0)
    rig.runs(MOVES_S)
    return rig


def _ahead(rig: VirtualRig, share: float) -> None:
    if rig.robot.kind == ARM:
        rig.operator.does(input="twist", speed_mps=0.02 * share)
    else:
        rig.operator.drives(SPEEDS.get(rig.robot.kind, 0.3) * share)


def driven(case: Case) -> Found:
    """Drive it."""
    try:
        with _moving(case.line, case.motion.name).branch() as rig:
            return _driven(rig, case)
    except BaseException:
        _moving.cache_clear()
        raise


def _driven(rig: VirtualRig, case: Case) -> Found:
    rig.runs(case.phase_ms / 1000.0)
    began, speed = rig.bench.world.now, rig.body.speed_mps
    _begin(rig, case)
    way, rest = _watched(rig, case.motion)
    cause = case.cause
    events = {event.name: event.began for event in reversed(rig.interlock_history) if event.began >= began}
    times = [at for name, at in events.items() if cause.reports and name.startswith(cause.reports)]
    outcome = Outcome(
        cause.name,
        case.line,
        case.motion.name,
        case.phase_ms,
        round(1000 * way),
        -1 if rest is None else round(1000 * rest),
        min((at - began) // MILLISECOND for at in times) if times else None,
        NO_ONE if rest is None else _by(rig, case.cause),
    )
    codes = {name: codes for name in rig.bench.devices.nodes(Epos2) if (codes := _history(rig, name))}
    return Found(outcome, frozenset(events), codes, _again(rig) / speed if cause.again else 0.0)


def _begin(rig: VirtualRig, case: Case) -> None:
    cause, motion = case.cause, case.motion
    if cause.order is not None:
        cause.order(rig.operator)
    what = _fault(rig, cause)
    if what is not None:
        hit = {"node": motion.axis or HIT[rig.robot.kind]} if what.hits else {}
        boards = [*ShieldLink.all_of(rig.robot), *Ar2Link.all_of(rig.robot)]
        link = {"link": boards[0]} if what.kind.startswith("board_") and len(boards) > 1 else {}
        rig.fault(what.kind, **hit, **link, **what.keys)
    if cause.returns_to_neutral:
        rig.operator.returns_to_neutral()
    elif what is not None and what.hits and motion.then:
        rig.operator.does(**motion.then)


def _fault(rig: VirtualRig, cause: Cause) -> Fault | None:
    if cause.fault is None or isinstance(cause.fault, Fault):
        return cause.fault
    boards = ShieldLink.all_of(rig.robot) or Ar2Link.all_of(rig.robot)
    return cause.fault["board" if boards else "serial" if rig.bench.lines else "can"]


def _watched(rig: VirtualRig, motion: Motion) -> tuple[float, float | None]:
    """Return how far it went, m, and when it stood, s; None where it did not stand."""
    looks = LOOKS if Ar2Link.all_of(rig.robot) else 1
    began, rest, way, places = rig.now, 0.0, 0.0, [_place(rig, motion)]
    while rig.now < began + min(WATCHED_S, rest + STILL_S):
        rig.runs(STEP_S)
        places.append(_place(rig, motion))
        mean = math.dist(places[-1], places[-1 - looks :][0]) / (looks * STEP_S)
        if max(mean, TURNS_AT_M * abs(rig.body.yaw_rate_rad_s)) > SLOWER_MPS:
            rest, way = rig.now - began, max(way, math.dist(places[-1], places[0]))
    return way, None if rest > WATCHED_S - 1.0 else rest


def _place(rig: VirtualRig, motion: Motion) -> tuple[float, ...]:
    """Return where the base is, an arm's tool, or the lift."""
    names = ("x_m", "tool_y_m", "y_m") if rig.robot.kind == ARM else ("x_m", "y_m")
    return tuple(getattr(rig.body, name) for name in (("lift_m",) if motion.lifts else names))


def _by(rig: VirtualRig, cause: Cause) -> str:
    """Return who stopped it: the bridge by the last stage of a stop, or the devices by themselves."""
    stops = rig.bench.bridge.stops.values()
    lost = any(stop.progress in (Progress.GIVEN_UP, Progress.NOT_REQUESTED) for stop in stops)
    if cause is KILLED or (cause is LINE_CUT and lost):
        return ALONE
    last = {stop.stages[min(stop.place, len(stop.stages) - 1)].name for stop in stops if stop.stages}
    return f"the bridge: {', '.join(sorted(last))}"


def _history(rig: VirtualRig, drive: str) -> tuple[int, ...]:
    """Return the codes in a drive's error history, newest first."""
    store = rig.bench.devices.nodes(Epos2)[drive].store
    count = store.get(ERROR_HISTORY_COUNT)
    return tuple(store.get(Address(0x1003, number + 1)) & 0xFFFF for number in range(count))


def _again(rig: VirtualRig) -> float:
    """Arm it, drive it straight ahead at half its speed, and return that speed, m/s."""
    rig.operator.returns_to_neutral()
    rig.runs(0.5)
    rig.operator.arms()
    rig.runs(1.5)
    _ahead(rig, AGAIN)
    rig.runs(2.5)
    return rig.body.speed_mps
