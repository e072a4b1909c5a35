"""A survey through the whole chain, RARS's purpose (A. P. Das, PhD thesis, IIT Delhi, 2018, 1, 2.1)."""

import csv
import math
from dataclasses import dataclass
from io import StringIO
from typing import Any, Final

import numpy as np
import pytest

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import Mission, MissionFileError
from emulators.bench.step import Step
from emulators.bench.survey_table import HEADINGS, Source, Survey, SurveyMission, csv_of, surveyed
from emulators.rig import Rig
from firmware_bridge.pilot.survey import Phase
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds, to_seconds

ROBOT: Final = find("rars")
BENCH_SETUP: Final = bench_setup_of(ROBOT)
CYCLE_S: Final = 0.05
EXTENDED_M: Final = ROBOT.geometry.limits.lift_retracted_m
CREEPS_MPS: Final = 0.003
"""A robot that stands, by the plant: its tyres and gears give way as the table moves."""


@dataclass
class Instant:
    """The robot at one instant, by the plant, and what the survey does."""

    at_s: float
    phase: Phase
    speed_mps: float
    lift_m: float
    detecting: bool


@dataclass
class Driven:
    """A survey that was driven."""

    operator: SurveyMission
    rig: Rig
    instants: list[Instant]

    def rows(self, seed: int = 0) -> list[dict[str, str]]:
        found = surveyed(self.operator.driver, self.operator.survey, self.rig.samples, seed)
        return list(csv.DictReader(StringIO(csv_of(found))))


def survey(**changed: Any) -> Mission:
    mission = missions.find("survey", ROBOT, BENCH_SETUP)
    assert mission.survey is not None
    return mission.model_copy(update={"survey": mission.survey.model_copy(update=changed)})


def drive(mission: Mission, seconds: float, *extra: Step) -> Driven:
    assert mission.survey is not None
    steps = tuple(sorted((*mission.step, *extra), key=lambda step: step.at_s))
    operator = SurveyMission(ROBOT, steps, mission.survey, BENCH_SETUP.step)
    rig, instants = Rig(ROBOT, BENCH_SETUP, operator, link=mission.conditions), []
    for cycle in range(1, round(seconds / CYCLE_S)):
        rig.run(from_seconds(cycle * CYCLE_S))
        now, values = rig.samples[-1], operator.station.shown.values
        instants.append(
            Instant(
                cycle * CYCLE_S,
                operator.driver.phase,
                now["speed_mps"],
                now["lift_m"],
                values.get("DETECT") == 1.0,
            )
        )
    rig.finish()
    return Driven(operator, rig, instants)


@pytest.fixture(scope="module")
def one_point() -> Driven:
    return drive(survey(points_m=((0.8, 0.1),), heights_m=(0.05, 0.12), reads_s=1.0), 24.0)


def test_it_drives_stands_lifts_reads_and_lowers(one_point: Driven) -> None:
    phases = [one_point.instants[0].phase]
    for instant in one_point.instants:
        if instant.phase is not phases[-1]:
            phases.append(instant.phase)
    expected = [Phase.DRIVES, Phase.STANDS, *(Phase.LIFTS, Phase.READS) * 2, Phase.LOWERS, Phase.ENDED]
    assert phases == expected
    readings = one_point.operator.driver.readings
    assert [round(one.height_m, 2) for one in readings] == [0.05, 0.12]
    assert all(math.dist((one.pose.x_m, one.pose.y_m), (0.8, 0.1)) < 0.03 for one in readings)


def test_at_no_instant_it_drives_with_the_table_up_or_reads_in_motion(one_point: Driven) -> None:
    for instant in one_point.instants:
        if instant.lift_m > EXTENDED_M:
            assert abs(instant.speed_mps) < CREEPS_MPS, instant
        if instant.phase is Phase.READS:
            assert instant.detecting, instant
            assert abs(instant.speed_mps) < CREEPS_MPS, instant
    assert not one_point.instants[-1].detecting
    assert one_point.instants[-1].lift_m < EXTENDED_M


def test_the_counts_are_those_of_the_true_place(one_point: Driven) -> None:
    rows = one_point.rows()
    assert list(rows[0]) == list(HEADINGS)
    source, background = one_point.operator.survey.source[0], one_point.operator.survey.background_per_s
    for row in rows:
        x, y, z = (float(row[f"true_{name}"]) for name in ("x_m", "y_m", "height_m"))
        apart = math.dist((x, y, 0.5 + z), (source.x_m, source.y_m, source.z_m))
        expected = background + source.per_s_at_1m / apart**2
        assert float(row["expected_per_s"]) == pytest.approx(expected, abs=0.01)
        # Five standard deviations of a Poisson count.
        counts, seconds = int(row["counts"]), float(row["seconds"])
        assert abs(counts - expected * seconds) < 5.0 * math.sqrt(expected * seconds)
    assert one_point.rows(0) == rows
    assert one_point.rows(1) != rows


def test_a_point_without_an_arc_is_left_out_with_its_reason_and_the_next_one_read() -> None:
    found = drive(survey(points_m=((-1.0, 0.0), (0.7, 0.0)), heights_m=(0.03,), reads_s=0.5), 24.0).rows()
    assert "only a loop leads there" in found[0]["why_not"]
    assert found[0]["counts"] == ""
    assert found[1]["counts"] != ""


def test_over_a_slow_link_it_reads_the_same_heights() -> None:
    mission = survey(points_m=((0.8, 0.1),), heights_m=(0.05, 0.12), reads_s=1.0).over("delay=0.8", None)
    driven = drive(mission, 36.0)
    assert [row["why_not"] for row in driven.rows()] == ["", ""]
    assert [round(float(row["true_height_m"]), 2) for row in driven.rows()] == [0.05, 0.12]
    assert driven.operator.driver.phase is Phase.ENDED
    for instant in driven.instants:
        assert instant.lift_m <= EXTENDED_M or abs(instant.speed_mps) < CREEPS_MPS, instant


def test_an_emergency_stop_ends_it_with_what_it_has(one_point: Driven) -> None:
    reads = [instant for instant in one_point.instants if instant.phase is Phase.READS]
    at_s = round(reads[0].at_s + 1.3, 2)
    stops = Step(at_s=at_s, title="emergency stop", emergency_stop=True)
    mission = survey(points_m=((0.8, 0.1),), heights_m=(0.05, 0.12), reads_s=1.0)
    driven = drive(mission, at_s + 6.0, stops)
    (first, rest) = driven.rows()
    assert first["counts"] != ""
    assert rest["why_not"].startswith("1 of 2 heights: ")
    after = [one for one in driven.instants if one.at_s > at_s + 1.0]
    assert max(one.lift_m for one in after) - min(one.lift_m for one in after) < 0.002
    assert all(abs(one.speed_mps) < CREEPS_MPS for one in after)


def test_disarmed_while_it_drives_and_while_it_lifts_it_goes_on_once_armed_again(one_point: Driven) -> None:
    lifts = next(one.at_s for one in one_point.instants if one.phase is Phase.LIFTS)
    breaks = [
        (5.0, "disarm"),
        (7.0, "arm"),
        (round(lifts + 3.5, 2), "disarm"),
        (round(lifts + 5.5, 2), "arm"),
    ]
    steps = [Step.model_validate({"at_s": at, "title": does, does: True}) for at, does in breaks]
    mission = survey(points_m=((0.8, 0.1),), heights_m=(0.05, 0.12), reads_s=1.0)
    driven = drive(mission, 34.0, *steps)
    assert [row["why_not"] for row in driven.rows()] == ["", ""]
    assert driven.operator.driver.phase is Phase.ENDED
    for instant in driven.instants:
        if any(begin + 1.0 < instant.at_s < begin + 2.0 for begin, does in breaks if does == "disarm"):
            assert abs(instant.speed_mps) < CREEPS_MPS, instant


@pytest.mark.long(beside="test_a_point_without_an_arc_is_left_out_with_its_reason_and_the_next_one_read")
def test_a_height_out_of_reach_is_given_up_and_the_table_lowered() -> None:
    driven = drive(survey(points_m=((0.6, 0.0),), heights_m=(5.0,), reads_s=0.5), 105.0)
    (row,) = driven.rows()
    assert row["why_not"] == "0 of 1 heights: 5 m was not reached"
    assert driven.operator.driver.phase is Phase.ENDED
    assert driven.instants[-1].lift_m < EXTENDED_M


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("points_m = []\nheights_m = [0.1]", "survey.points_m"),
        ("points_m = [[1.0, 0.0]]\nheights_m = [-0.1]", "survey.heights_m[0]"),
        ("points_m = [[1.0, 0.0]]\nheight_m = [0.1]", "survey.height_m: no such key; perhaps 'heights_m'?"),
        (
            "points_m = [[1.0, 0.0]]\nheights_m = [0.1]\n[[survey.source]]\nx_m = 1.0\ny_m = 0.0",
            "survey.source[0].per_s_at_1m",
        ),
        ("points_m = [[1.0, 0.0]]\nheights_m = [0.1]\n[pilot]\npath = 'line'", "a pilot or a survey"),
    ],
)
def test_a_survey_that_makes_no_sense_is_refused(text: str, reported: str) -> None:
    head = 'title = "t"\nduration_s = 9.0\n[[step]]\nat_s = 0.0\ntitle = "s"\narm = true\n[survey]\n'
    with pytest.raises(MissionFileError) as refused:
        missions.parse(f"{head}{text}\n", "my.toml", ROBOT, BENCH_SETUP)
    assert reported in str(refused.value)


def test_a_robot_without_a_detector_is_refused() -> None:
    rome = find("rome")
    with pytest.raises(MissionFileError, match="rome has no lift with a switch 'detector' on it"):
        missions.parse(survey().text, "my.toml", rome, bench_setup_of(rome))


def test_inside_a_source_the_counts_have_a_bound() -> None:
    table = Survey(
        points_m=((0.0, 0.0),), heights_m=(0.0,), source=(Source(x_m=0.0, y_m=0.0, z_m=0.5, per_s_at_1m=1.0),)
    )
    assert table.expected(0.0, 0.0, 0.0) == pytest.approx(1e4 + 1.0)
    assert table.expected(3.0, 4.0, 0.0) == pytest.approx(1.0 / 25.0 + 1.0)


@pytest.mark.long(beside="test_it_drives_stands_lifts_reads_and_lowers")
def test_the_shipped_survey_reads_all_its_points() -> None:
    mission = survey()
    driven = drive(mission, mission.duration_s)
    rows = driven.rows()
    assert [row["point"] for row in rows] == ["1", "1", "2", "2", "3", "3"]
    assert all(row["counts"] for row in rows)
    off = [
        math.dist([float(row[f"true_{name}"]) for name in ("x_m", "y_m")], point)
        for row, point in zip(rows, np.repeat(mission.survey.points_m, 2, axis=0), strict=True)  # type: ignore[union-attr] # it has one
    ]
    assert max(off) < 0.05
    assert to_seconds(driven.operator.driver.readings[-1].ends) < mission.duration_s
