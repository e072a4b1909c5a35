import math
from pathlib import Path as FilePath

import pytest

from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot import path_file
from firmware_bridge.pilot.paths import PATHS, Path, PathError, circle, figure_of_eight, line, placed


@pytest.mark.parametrize(
    ("path", "length", "closed"),
    [
        (line(3.0), 3.0, False),
        (circle(5.0), 10.0 * math.pi, True),
        (figure_of_eight(2.0), 8.0 * math.pi, True),
    ],
)
def test_a_path_begins_at_the_origin_along_x(path: Path, *, length: float, closed: bool) -> None:
    assert path.begin == Pose(0.0, 0.0, 0.0)
    assert (path.at(0.0).x_m, path.at(0.0).y_m) == (0.0, 0.0)
    assert path.length_m == pytest.approx(length, rel=1e-5)
    assert path.closed is closed


def test_a_circle_is_round_to_a_tenth_of_a_millimeter() -> None:
    path = circle(5.0)
    for along in range(32):
        place = path.at(float(along))
        assert math.hypot(place.x_m, place.y_m - 5.0) == pytest.approx(5.0, abs=1e-4)


def test_an_eight_turns_left_then_right() -> None:
    path = figure_of_eight(2.0)
    assert path.at(2.0 * math.pi).y_m == pytest.approx(4.0, abs=1e-3)
    assert path.at(6.0 * math.pi).y_m == pytest.approx(-4.0, abs=1e-3)


@pytest.mark.parametrize(
    ("point", "along", "left"),
    [
        ((1.0, 0.5), 1.0, 0.5),
        ((1.0, -0.5), 1.0, -0.5),
        ((4.0, 0.0), 3.0, 1.0),  # behind the end: how far from it
        ((-3.0, -4.0), 0.0, -5.0),
    ],
)
def test_the_nearest_place_of_a_line_and_its_side(
    point: tuple[float, float], along: float, left: float
) -> None:
    assert line(3.0).nearest(point) == pytest.approx((along, left))


def test_where_an_eight_crosses_itself_it_is_looked_for_near_the_place_before() -> None:
    path, half = figure_of_eight(2.0), 4.0 * math.pi
    assert path.nearest((0.05, -0.001), half - 0.5, half + 0.5).along_m == pytest.approx(
        half + 0.05, abs=0.01
    )
    assert path.nearest((0.05, 0.001), -0.5, 0.5).along_m == pytest.approx(0.05, abs=0.01)


@pytest.mark.parametrize(("offset", "turned"), [(0.0, 0.0), (0.01, 0.0), (0.5, -90.0), (-0.3, 30.0)])
def test_a_path_is_placed_so_that_the_robot_stands_beside_it(offset: float, turned: float) -> None:
    robot = Pose(3.0, -2.0, 0.7)
    path = placed(circle(5.0), robot, offset_m=offset, turned_rad=math.radians(turned))
    nearest = path.nearest((robot.x_m, robot.y_m))
    assert nearest.left_m == pytest.approx(offset, abs=2e-4)
    course = path.begin.heading_rad
    assert math.remainder(robot.heading_rad - course, math.tau) == pytest.approx(
        math.radians(turned), abs=1e-12
    )


@pytest.mark.parametrize(
    "points", [[], [(0.0, 0.0)], [(0.0, 0.0), (0.0, 0.0)], [(0.0, 0.0), (math.nan, 0.0)]]
)
def test_what_is_no_path_is_refused(points: list[tuple[float, float]]) -> None:
    with pytest.raises(PathError):
        Path(points)


def test_a_path_comes_from_a_file(tmp_path: FilePath) -> None:
    file = tmp_path / "way.csv"
    file.write_text("x,y\n0,0\n# a corner\n2, 0\n\n2,1\n", encoding="utf-8")
    path = path_file.load(file)
    assert (path.length_m, path.closed) == (3.0, False)
    file.write_text("0,0\n2,0\n2,1\n0,0\n", encoding="utf-8")
    assert path_file.load(file).closed
    file.write_text("t,x,y,psi\n0,0,0,0\n5,2,0,0\n9,2,1,0\n", encoding="utf-8")
    assert path_file.load(file).points == ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0))


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("0,0\n1,zwei\n", "row 2: y = 'zwei'"),
        ("0\n", "row 1"),
        ("x,y\n0,0\n", "1 points make no path"),
        ("0,0\n0,0\n", "two points at least"),
    ],
)
def test_a_wrong_file_is_one_line(tmp_path: FilePath, text: str, reported: str) -> None:
    file = tmp_path / "way.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(PathError, match=reported) as refused:
        path_file.load(file)
    assert str(file) in str(refused.value)


def test_a_file_that_is_not_there_is_named(tmp_path: FilePath) -> None:
    with pytest.raises(PathError, match="cannot be read"):
        path_file.load(tmp_path / "none.csv")


def test_the_paths_have_names() -> None:
    assert set(PATHS) == {"line", "circle", "eight"}
