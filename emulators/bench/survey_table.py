"""A survey in a mission file, and the detector that is emulated for it.

The detector counts what sources send through it: their strength over the square of the distance, and a
background, by chance of the run's seed. No shielding, no scatter, no dead time: assumed.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Annotated, Final, NamedTuple, TypeAlias

import numpy as np
from pydantic import Field

from emulators.bench import orders
from emulators.bench.columns import ODOMETRY, POSE, Samples
from emulators.bench.station_mission import Reach, StationMission
from emulators.bench.step import Finite, NonNegative, Positive, Step, inputs
from firmware_bridge.motion.model import MotionModel, Unicycle
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.follower import PathDriver
from firmware_bridge.pilot.goals import path_to
from firmware_bridge.pilot.paths import Path, Point, placed
from firmware_bridge.pilot.survey import Plan, Reading, SurveyDriver
from firmware_bridge.pilot.survey import Table as Lifting
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.table import Table
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds

STREAM: Final = 3
"""The detector draws from this stream of the seed."""
NEAREST_M: Final = 0.01
"""Nearer than this a source is inside the detector."""
DETECTOR: Final = "detector"
"""The switch that switches it on, and the key of a step that does."""
LIFT: Final = "lift_m"
"""The key of a step that moves the table to a height."""
Values: TypeAlias = Callable[[], Mapping[str, float]]
HEADINGS: Final = (
    *("point", "x_m", "y_m", "height_m", "true_x_m", "true_y_m", "true_height_m"),
    *("seconds", "counts", "per_s", "expected_per_s", "why_not"),
)


Place: TypeAlias = Annotated[tuple[Finite, Finite], Field(strict=False)]


class Source(Table):
    """A point source, where the robot begins: ahead, to the left, and over the floor."""

    x_m: Finite
    y_m: Finite
    z_m: NonNegative = 0.0
    per_s_at_1m: Positive
    """Counts a second of the detector at a distance of 1 m."""


class Survey(Table):
    """Readings of a detector at points, each at several heights."""

    points_m: Annotated[tuple[Place, ...], Field(min_length=1, strict=False)]
    """Where it reads, in this order: m ahead and to the left of where it begins."""
    heights_m: Annotated[tuple[NonNegative, ...], Field(min_length=1, strict=False)]
    """Heights of the table above its lowest, in this order."""
    reads_s: Positive = 3.0
    """Time of each reading."""
    speed_mps: Positive = 0.3
    look_ahead_m: Positive = 0.5
    loop: bool = False
    """Permits a loop where no arc leads to a point: it needs space."""
    lowest_m: NonNegative = 0.5
    """Height of the lowered detector over the floor."""
    background_per_s: NonNegative = 1.0
    source: Annotated[tuple[Source, ...], Field(strict=False)] = ()

    def expected(self, x_m: float, y_m: float, height_m: float) -> float:
        """Return the counts a second of a detector there; the height above its lowest."""
        z = self.lowest_m + height_m
        return self.background_per_s + sum(
            one.per_s_at_1m / max(math.dist((x_m, y_m, z), (one.x_m, one.y_m, one.z_m)), NEAREST_M) ** 2
            for one in self.source
        )

    @staticmethod
    def lacks(robot: AnyRobot, step: type[Step]) -> str:
        """Return what a robot lacks to survey; empty where it has all. `step` is of its missions."""
        rows = robot_type_of(robot).station
        named = {switch.name for switch in rows.switches if switch.telemetry}
        if rows.lifted and DETECTOR in named and {LIFT, DETECTOR} <= inputs(step).keys():
            return ""
        return f"{robot.name} has no lift with a switch '{DETECTOR}' on it"

    def driver(self, robot: AnyRobot, reach: Reach, table: Lifting, values: Values) -> SurveyDriver:
        """Return what drives it, by what the robot can drive and its newest values."""
        plan = Plan(self.points_m, self.heights_m, from_seconds(self.reads_s))
        return SurveyDriver(plan, table, partial(self._leg, robot, reach), values)

    def _leg(self, robot: AnyRobot, reach: Reach, point: Point) -> PathDriver:
        robot_type = robot_type_of(robot)
        model: MotionModel = Unicycle() if robot_type.model is None else robot_type.model(robot)
        fastest = robot.operator.speed_share * robot_type.station.largest(robot).forward_mps
        return PathDriver(
            partial(self._path, reach, point),
            speed_mps=min(self.speed_mps, fastest),
            look_ahead_m=self.look_ahead_m,
            tightest_per_m=model.tightest_per_m,
        )

    def _path(self, reach: Reach, point: Point, at: Pose) -> Path:
        """Return the path to a point from where it stands; PathError where none may be driven."""
        dx, dy = point[0] - at.x_m, point[1] - at.y_m
        cos, sin = math.cos(at.heading_rad), math.sin(at.heading_rad)
        goal = (cos * dx + sin * dy, cos * dy - sin * dx)
        return placed(path_to(goal, reach(), loop=self.loop), at)


class SurveyMission(StationMission):
    """A `Node`: the station, a mission's steps, and the survey that it drives."""

    def __init__(self, robot: AnyRobot, steps: tuple[Step, ...], survey: Survey, step: type[Step]) -> None:
        """Take the robot's own class of steps, too: its table and detector are ordered by them."""
        self.survey: Final = survey
        self._step: Final = step
        rows = robot_type_of(robot).station
        (reported,) = (switch.telemetry for switch in rows.switches if switch.name == DETECTOR)
        table = Lifting(rows.lifted, reported, partial(self._orders, LIFT), partial(self._orders, DETECTOR))
        self.driver: Final = survey.driver(robot, self.reach, table, lambda: self.station.shown.values)
        super().__init__(robot, steps, self.driver)

    def _orders(self, key: str, value: float, now: Nanoseconds) -> None:
        given = self._step.model_validate({"at_s": 0.0, "title": key, key: value})
        for one in orders.of_step(given, self._robot, now):
            self.station.order(one.title, one.number, one.params, now)


class Surveyed(NamedTuple):
    """One reading as a row of the map; without one only its point, and why."""

    point: int
    """Counted from 1."""
    believed: tuple[float, float, float] | None
    """x, y and height in m by the robot's own pose."""
    true: tuple[float, float, float] | None
    """The same by the plant."""
    seconds: float = 0.0
    counts: int = 0
    expected_per_s: float = 0.0
    why_not: str = ""

    @property
    def per_s(self) -> float:
        """Counts a second."""
        return self.counts / self.seconds if self.seconds else math.nan


def surveyed(driver: SurveyDriver, survey: Survey, samples: Samples, seed: int) -> list[Surveyed]:
    """Return the map of a run: each reading counted where the detector truly was."""
    chance = np.random.default_rng([seed, STREAM])
    rows = [_counted(one, survey, samples, chance) for one in driver.readings]
    whole = len(survey.heights_m)
    for number in range(len(survey.points_m)):
        found = sum(row.point == number + 1 for row in rows)
        if found < whole:
            why = driver.refused.get(number, f"{driver.phase.value} when the run ended")
            rows.append(Surveyed(number + 1, None, None, why_not=f"{found} of {whole} heights: {why}"))
    return sorted(rows, key=lambda row: row.point)


def _counted(one: Reading, survey: Survey, samples: Samples, chance: np.random.Generator) -> Surveyed:
    at = samples.seconds
    during = (at >= to_seconds(one.begins)) & (at <= to_seconds(one.ends))
    names = (*(POSE if samples.truth else ODOMETRY)[:2], "lift_m")
    places = np.column_stack([samples.column(name)[during] for name in names])
    seconds = to_seconds(one.ends - one.begins)
    # It may sink or creep while it reads: the mean of what it receives.
    rate = float(np.mean([survey.expected(*map(float, place)) for place in places]))
    x, y, z = (float(value) for value in places.mean(axis=0))
    return Surveyed(
        one.point + 1,
        (one.pose.x_m, one.pose.y_m, one.height_m),
        (x, y, z),
        seconds,
        int(chance.poisson(rate * seconds)),
        rate,
    )


def csv_of(rows: list[Surveyed]) -> str:
    """Return the map as CSV, a reading a line; SI units."""
    return "\n".join((",".join(HEADINGS), *map(_line, rows), ""))


def _line(row: Surveyed) -> str:
    def numbers(place: tuple[float, float, float] | None) -> Iterator[str]:
        return (("" if place is None else f"{value:.4f}") for value in place or ("", "", ""))

    read = ("", "", "", "")
    if row.believed is not None:
        read = (f"{row.seconds:.2f}", str(row.counts), f"{row.per_s:.3f}", f"{row.expected_per_s:.3f}")
    quoted = row.why_not.replace('"', "'")
    return ",".join(
        (str(row.point), *numbers(row.believed), *numbers(row.true), *read, f'"{quoted}"' if quoted else "")
    )
