"""Drives one cause of a stop on the whole bench, and measures by the plant's truth what comes of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final, NamedTuple

import numpy as np

from emulators.bench.faults import Fault
from emulators.rig import BRIDGE
from emulators.robots.rars import RarsStep as Step
from firmware_bridge.drivers.epos2.serial.fleet import over_serial
from firmware_bridge.kinds import find
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from hil_tests.failures.cases import LETS_GO, MOTIONS, PHASES_MS, By, Cause, Motion
from hil_tests.scenarios.ride import ARMED, STANDS, Ride, fault, ride, step, story

RARS: Final[AnyRobot] = find("rars")
ROBOTS: Final = {"can": RARS, "serial": over_serial(RARS)}
MOVES_S: Final = 4.0
BEGINS_S: Final = 6.0
THEN_S: Final = 0.1
WATCHED_S: Final = 15.0
LASTS_S: Final = 60.0
STILL_S: Final = 1.5
"""Who has not moved for so long has come to rest; no step of a stop takes longer."""
SLOWER_MPS: Final = 0.005
"""The base's: free tyres swing by less for seconds. The lift has no tyres, but shares the rule."""


class Draw(NamedTuple):
    """One way to begin."""

    link: str
    motion: Motion
    phase_ms: int

    @property
    def begins(self) -> Nanoseconds:
        """The instant."""
        return from_seconds(BEGINS_S) + self.phase_ms * MILLISECOND


@dataclass(frozen=True, slots=True, order=True)
class Came:
    """What came of it, by the plant's truth."""

    way_mm: int
    """Of the base's reference point along its path, or of the lift, until it came to rest."""
    rest_ms: int
    noticed_ms: int | None
    """Until the first of the holds that notice it; None where there was none."""


class Driven(NamedTuple):
    """What came of it, and what was held since."""

    came: Came
    holds: frozenset[str]


class Moving:
    """A robot that drives or lifts as a motion says; each cause goes on from there."""

    def __init__(self, link: str, motion: Motion) -> None:
        """Drive until just before anything begins."""
        moves = {"at_s": MOVES_S, "title": "it moves", **motion.steps}
        self._begun: Final = (ARMED, Step.model_validate(moves))
        self._ride: Final = ride(*self._begun, seconds=LASTS_S, robot=ROBOTS[link])
        self._ride.runs_until(BEGINS_S - 0.1)
        self._moment: Final = self._ride.rig.snapshot()

    def fork(self, steps: Sequence[Step], faults: Sequence[Fault]) -> Ride:
        """Go back, and on with these steps and faults."""
        self._ride.rig.restore(self._moment)
        self._ride.operator.take_over(story(STANDS, *self._begun, *steps, seconds=LASTS_S))
        self._ride.rig.faults.plan(faults)
        return Ride(self._ride.rig, self._ride.operator)


@cache
def moving(link: str, motion: str) -> Moving:
    """Return the robot that moves so; it is driven there once."""
    return Moving(link, next(one for one in MOTIONS if one.name == motion))


def driven(cause: Cause, draw: Draw) -> Driven:
    """Drive it; who moved at the end has come to no rest, and AssertionError says so."""
    steps, faults = [], []
    second = BEGINS_S + draw.phase_ms / 1000.0
    if cause.by is By.OPERATOR:
        steps.append(step(second, **_meant(cause.how, draw.motion)))
    if cause.by is By.FAULT:
        hit = {"node": draw.motion.axis} if cause.hits else {}
        faults.append(fault(cause.what, second, **hit, **cause.how))
    if cause.also:
        steps.append(step(second, **_meant(cause.also, draw.motion)))
    elif cause.hits and draw.motion.then:
        steps.append(step(second + THEN_S, **draw.motion.then))
    one = moving(draw.link, draw.motion.name).fork(steps, faults)
    came = _watched(one, cause, draw)
    return Driven(came, frozenset(hold.name for hold in one.rig.holds if hold.began >= draw.begins))


def _meant(keys: Mapping[str, object], motion: Motion) -> dict[str, object]:
    """Return the keys of a step; a channel that the motion leaves alone stays alone."""
    return {key: value for key, value in keys.items() if key not in LETS_GO or key in motion.steps}


def _watched(one: Ride, cause: Cause, draw: Draw) -> Came:
    one.rig.run(draw.begins)
    if cause.what == "ends":
        one.ends()
    elif cause.what == "dies":
        one.rig.world.silence(BRIDGE, one.rig.world.now)
    ways = np.zeros(1)
    while one.rig.world.now < draw.begins + from_seconds(WATCHED_S):
        one.runs(0.5)
        ways = _ways(one, draw)
        if len(ways) * 10 > STILL_S * 1000 and ways[-1] - ways[-int(STILL_S * 100)] < SLOWER_MPS * STILL_S:
            break
    moving = np.nonzero(np.diff(ways) > SLOWER_MPS / 100.0)[0]
    last = int(moving[-1]) + 1 if moving.size else 0
    assert last < len(ways) - 1, f"{cause.name}: it still moves {WATCHED_S:g} s later"
    began = [hold.began for hold in one.rig.holds if hold.name.startswith(cause.tells or ("-",))]
    noticed = min((at for at in began if at >= draw.begins), default=None)
    return Came(
        way_mm=round(1000.0 * ways[last]),
        rest_ms=10 * last,
        noticed_ms=None if noticed is None else (noticed - draw.begins) // MILLISECOND,
    )


def _ways(one: Ride, draw: Draw) -> np.ndarray:
    """Return how far it has gone since it began, at each sample since."""
    rows = [row for row in one.rig.samples if row.at >= draw.begins]
    if draw.motion.lifts:
        steps = np.abs(np.diff([row["lift_m"] for row in rows]))
    else:
        steps = np.hypot(np.diff([row["x_m"] for row in rows]), np.diff([row["y_m"] for row in rows]))
    return np.concatenate(([0.0], np.cumsum(steps)))


def draws(cause: Cause) -> list[Draw]:
    """Return every way to begin it."""
    return [
        Draw(link, motion, phase) for link in cause.links for motion in cause.motions for phase in PHASES_MS
    ]
