"""Pure pursuit by video: two pictures a second, each 0.5 s old, [R] App. A and 6.1.

Ours is the pilot's own pursuit behind its video feed, and its predictor. The independent way counts pictures
by their numbers, and puts the goal by the cosine rule. Amplitudes are not printed: they are this project's.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from firmware_bridge.motion.model import Moving, Unicycle
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.driver import Sight
from firmware_bridge.pilot.paths import circle, placed
from firmware_bridge.pilot.predictor import Predictor
from firmware_bridge.pilot.pursuit import Pursuit
from firmware_bridge.pilot.video import Video, VideoFeed
from validation.rars.delay import RADIAL, RADIUS, bend
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot

TICKS: Final = 60
"""Per second: pictures at 30 Hz come each second tick, commands at 20 Hz each third."""
TICK_NS: Final = 16_666_667
"""Rounded up, so that a picture due after whole ticks has come by then."""
COMMAND: Final = 3
SECONDS: Final = 120
LAST: Final = 20
"""s, at the end, in which the swing is looked at."""
UNKNOWN_LAG: Final = 6
"""Ticks, 0.1 s: from a command to its effect, unknown to the predictor."""
SETTLED_S: Final = 20


@dataclass(frozen=True)
class Case:
    """One drive."""

    title: str
    rate_hz: float
    speed: float = 0.5
    look_ahead: float = 0.5
    predicted: bool = False
    lag: int = 0
    """Ticks."""


CASES: Final = (
    Case("30 Hz, 0.5 m/s", 30.0),
    Case("2 Hz, 0.5 m/s", 2.0),
    Case("2 Hz, 0.4 m/s", 2.0, speed=0.4),
    Case("2 Hz, 0.3 m/s", 2.0, speed=0.3),
    Case("2 Hz, 0.5 m/s, look-ahead 0.8 m", 2.0, look_ahead=0.8),
    Case("2 Hz, 0.5 m/s, predicted", 2.0, predicted=True),
    Case("2 Hz, 0.5 m/s, predicted, 0.1 s of unknown lag", 2.0, predicted=True, lag=UNKNOWN_LAG),
)
DRAWN: Final = (CASES[0], CASES[1], CASES[3], CASES[5])


def video(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study; a quick one is the same."""
    del quick
    return Findings(
        compared=tuple(
            Compared(
                f"swing about the path: {case.title}",
                "mm",
                None,
                1e3 * swing(counted(case)),
                1e3 * swing(piloted(case)),
                1.0,
                "amplitudes are not printed",
            )
            for case in CASES
        ),
        plots=(
            Plot(
                "Pure pursuit on the circle of 5 m by pictures that are 0.5 s old",
                "time [s]",
                "distance from the center [m]",
                tuple(Curve(case.title, *_radius(piloted(case))) for case in DRAWN),
                "Ideal robot, look-ahead 0.5 m, from (4.5, 0) looking radially out; commands at 20 Hz. What "
                "is seen is 0.5 s to 1 s old at 2 Hz, and the robot swings for ever; predicted from the "
                "picture by the commands sent since, it does not.",
            ),
            Plot(
                "The same from above, last 20 s",
                "x [m]",
                "y [m]",
                tuple(Curve(case.title, *piloted(case)[-LAST * TICKS :].T) for case in DRAWN),
                "The last 20 s of the drives above.",
                equal=True,
            ),
        ),
        remarks=(
            (
                "Printed are the rate of 2 Hz and the age of 0.5 s; start, speed and look-ahead are those of "
                "5.3. `bench rars --mission video` drives the whole chain by the same pictures: it swings by "
                "0.19 m, less than the ideal robot, as its pilot slows down in tight arcs."
            ),
        ),
    )


def swing(rows: Floats) -> float:
    """Return half of peak to peak of the distance to the center in the last seconds, m."""
    return float(np.ptp(np.hypot(*rows[-LAST * TICKS :].T))) / 2.0


def off(rows: Floats) -> float:
    """Return the largest distance from the circle after 20 s, m."""
    return float(np.abs(np.hypot(*rows[SETTLED_S * TICKS :].T) - RADIUS).max())


@cache
def piloted(case: Case) -> Floats:
    """Return x and y at each tick: the pilot's pursuit sees pictures, and with a predictor the present."""
    pursuit = Pursuit(placed(circle(RADIUS), Pose(RADIUS, 0.0, math.pi / 2.0)), case.look_ahead)
    feed, predictor = VideoFeed(Video(case.rate_hz)), Predictor(Unicycle())
    seen = Sight(Moving(RADIAL), 0, 0)

    def turn(tick: int, moving: Moving) -> float | None:
        nonlocal seen
        now = tick * TICK_NS
        feed.filmed(Sight(moving, now, now))
        picture = feed.shown(now)
        if picture is not None:
            seen = picture
            predictor.seen(picture.measured_at or 0, picture.moving)
        if tick % COMMAND:
            return None
        predicted = predictor.at(now) if case.predicted else None
        pose = (predicted or seen.moving).pose
        rate = case.speed * pursuit.arc(pose).curvature_per_m
        predictor.on_command(now, 0, case.speed, rate)
        return rate

    return _driven(case, turn)


@cache
def counted(case: Case) -> Floats:
    """Return the same without the pilot: pictures by their numbers, the goal by the cosine rule."""
    poses: list[Pose] = []
    sent: list[float] = []
    each, age = round(TICKS / case.rate_hz), TICKS // 2

    def turn(tick: int, moving: Moving) -> float | None:
        poses.append(moving.pose)
        if tick % COMMAND:
            return None
        picture = max((tick - age) // each * each, 0)
        x, y, heading = poses[picture].x_m, poses[picture].y_m, poses[picture].heading_rad
        # Before the first picture nothing is known to predict from but the start.
        if case.predicted and tick >= age:
            for step in range(picture, tick):
                rate = sent[step // COMMAND]
                middle, way = heading + rate / TICKS / 2.0, case.speed / TICKS
                x, y = x + way * math.cos(middle), y + way * math.sin(middle)
                heading += rate / TICKS
        sent.append(case.speed * bend(x, y, heading, case.look_ahead))
        return sent[-1]

    return _driven(case, turn)


def _driven(case: Case, turn: Callable[[int, Moving], float | None]) -> Floats:
    model, moving, rates = Unicycle(), Moving(RADIAL), []
    places = [(RADIAL.x_m, RADIAL.y_m)]
    rate = 0.0
    for tick in range(SECONDS * TICKS):
        wanted = turn(tick, moving)
        rate = rate if wanted is None else wanted
        rates.append(rate)
        acts = rates[tick - case.lag] if tick >= case.lag else 0.0
        moving = model.step(moving, case.speed, acts, 1.0 / TICKS)
        places.append((moving.pose.x_m, moving.pose.y_m))
    return np.array(places)


def _radius(rows: Floats) -> tuple[Floats, Floats]:
    radius: Floats = np.hypot(*rows.T)
    return np.arange(len(rows)) / TICKS, radius
