"""Drives one cause of a stop on the whole bench, and measures by the plant's truth what comes of it."""

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from emulators.rig import BRIDGE
from emulators.robots.rars import RarsStep as Step
from firmware_bridge.drivers.epos2.serial.fleet import over_serial
from firmware_bridge.kinds import find
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from hil_tests.failures.cases import PHASES_MS, By, Cause, Motion
from hil_tests.scenarios.ride import ARMED, Ride, fault, ride, step

RARS: Final[AnyRobot] = find("rars")
ROBOTS: Final = {"can": RARS, "serial": over_serial(RARS)}
MOVES_S: Final = 4.0
BEGINS_S: Final = 6.0
WATCHED_S: Final = 15.0
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


def driven(cause: Cause, draw: Draw) -> tuple[Came, Ride]:
    """Drive it; who moved at the end has come to no rest, and AssertionError says so."""
    steps, faults = [], []
    second = BEGINS_S + draw.phase_ms / 1000.0
    match cause.by:
        case By.OPERATOR:
            steps.append(step(second, **_of(cause, draw.motion)))
        case By.FAULT:
            hit = {"node": draw.motion.axis} if cause.hits else {}
            faults.append(fault(cause.what, second, **hit, **cause.how))
    moves = Step.model_validate({"at_s": MOVES_S, "title": "it moves", **draw.motion.steps})
    one = ride(ARMED, moves, *steps, seconds=60.0, robot=ROBOTS[draw.link], faults=faults)
    try:
        return _watched(one, cause, draw), one
    finally:
        one.rig.finish()


def _of(cause: Cause, motion: Motion) -> dict[str, object]:
    """Return the keys of the step; a channel that the motion leaves alone stays alone."""
    channels = {"speed_mps", "steer_deg", "lift_rate_mps"}
    return {key: value for key, value in cause.how.items() if key not in channels or key in motion.steps}


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
