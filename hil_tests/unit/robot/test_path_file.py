"""A path from a file: what the columns may be, and what is wrong, with file and row."""

import math
from pathlib import Path

import numpy as np
import pytest

from emulators.bench.along import along_mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import parse
from firmware_bridge.robot.path_file import PathFileError, path_of, points_of, sampled, with_path
from firmware_bridge.robot_types import find


@pytest.mark.parametrize(
    ("text", "speed", "points"),
    [
        ("0,1,2\n2,1.5,2\n", None, ((0, 1, 2, 0), (2, 1.5, 2, 0))),
        ("t, x, y, psi\n0, 0, 0, 0\n# half way\n\n1, 0.1, 0, 0.5\n", None, ((0, 0, 0, 0), (1, 0.1, 0, 0.5))),
        ("x,y\n0,0\n3,4\n3,5\n", 0.5, ((0, 0, 0, 0), (10, 3, 4, 0), (12, 3, 5, 0))),
    ],
)
def test_a_table_is_a_path(text: str, speed: float | None, points: tuple[tuple[float, ...], ...]) -> None:
    assert points_of(text, "p.csv", speed) == points


@pytest.mark.parametrize(
    ("text", "speed", "message"),
    [
        ("", None, "p.csv: there is no point in it"),
        ("t,x,y\n0,0,0\n", None, "p.csv: 1 points make no path; at least 2 do"),
        ("0,0,0\n1,0,0\n1,1,0\n", None, "p.csv: row 3: t = 1 is not later than 1"),
        ("0,0,0\n\n1,zwei,0\n", None, "p.csv: row 3: x = 'zwei' is no finite number"),
        ("0,0,0\n1,nan,0\n", None, "p.csv: row 2: x = 'nan' is no finite number"),
        ("0,0,0\n1,0\n", None, "p.csv: row 2: 2 columns, expected t, x, y"),
        ("1\n", None, "p.csv: row 1: 1 columns; give x, y; t, x, y; t, x, y, psi"),
        ("x,y,t\n", None, "p.csv: row 1: the columns are 'x, y, t'; give x, y; t, x, y; t, x, y, psi"),
        (
            "0,0\n1,0\n",
            None,
            "p.csv: its points have no times: use --path-speed M/S, or add a column t",
        ),
        ("0,0\n0,0\n", 0.1, "p.csv: row 2: the same point again: without a time it takes none"),
        ("0,0,0\n1,0,0\n", 0.1, "p.csv: its points have times: a speed is for points without"),
    ],
)
def test_what_is_wrong_is_one_line_with_file_and_row(text: str, speed: float | None, message: str) -> None:
    with pytest.raises(PathFileError) as caught:
        points_of(text, "p.csv", speed)
    assert str(caught.value) == message


def test_a_function_is_a_path() -> None:
    points = sampled(lambda t: (math.cos(t), math.sin(t), 0.0), 1.0, 0.4)
    assert [point[0] for point in points] == [0.0, 0.4, 0.8, 1.0]
    assert points[1] == (0.4, math.cos(0.4), math.sin(0.4), 0.0)


@pytest.mark.parametrize(
    ("robot", "points", "message"),
    [
        ("rome", ((0, 0, 0, 0), (1, 1, 0, 0)), "the path points needs 1 m/s, limits.speed_mps leaves 0.568"),
        ("rars", ((0, 0, 0, 0), (9, 1, 0, 0)), "rars has no path follower that takes a path by points"),
    ],
)
def test_a_path_that_the_robot_cannot_take_is_refused(
    robot: str, points: tuple[tuple[float, float, float, float], ...], message: str
) -> None:
    with pytest.raises(PathFileError, match=message):
        with_path(find(robot), points, "p.csv")


def test_the_bench_drives_along_a_path_of_its_own_to_its_end() -> None:
    points = ((0.0, 0.0, 0.0, 0.0), (8.0, 1.0, 0.0, 0.0))
    robot = with_path(find("rome"), points, "p.csv")
    mission = parse(along_mission(points), "--path", robot, bench_setup_of(robot))
    assert [(step.at_s, step.path_follower) for step in mission.step] == [
        (4.0, None),
        (5.0, "points"),
        (15.0, ""),
    ]
    assert mission.duration_s == 17.0
    x, y = bench_setup_of(robot).paths["points"](robot)(np.array([4.0]))
    assert (float(x[0]), float(y[0])) == (0.5, 0.0)


def test_a_file_that_is_none_is_reported(tmp_path: Path) -> None:
    with pytest.raises(PathFileError, match=r"none\.csv: cannot be read"):
        path_of(tmp_path / "none.csv")
