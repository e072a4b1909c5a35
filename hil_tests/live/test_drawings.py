"""Robots from above, and an arm from the side: their geometry is what the robot file and the bridge state."""

import math
from itertools import pairwise
from typing import Any

import pytest

from firmware_bridge.live.state import outline_named, outline_of
from firmware_bridge.robot_types import find
from hil_tests.live.shown_bench import shown

Polygon = list[list[float]]


def middle(polygon: Polygon) -> tuple[float, float]:
    """Return the mean of a polygon's corners."""
    x, y = (sum(one) / len(polygon) for one in zip(*polygon, strict=True))
    return round(x, 3), round(y, 3)


def rolls(polygon: Polygon) -> float:
    """Return the direction of a rectangle's longer sides, degrees, from 0 to 180."""
    (ax, ay), (bx, by), *_ = polygon
    return round(math.degrees(math.atan2(ay - by, ax - bx)), 2) % 180.0


WHEELS: list[tuple[str, list[tuple[float, float]], list[float]]] = [
    # [R] Tab. 3.1, 2.4.1 and 2.3.1: track 0.4 m, wheelbase 0.515 m, front contacts 0.168 m from the middle.
    ("rars", [(0.0, 0.2), (0.0, -0.2), (0.515, 0.168), (0.515, -0.168)], [0.0] * 4),
    # Three wheels at 0, 120 and 240 degrees, each across its radius.
    ("rome", [(0.16, 0.0), (-0.08, 0.139), (-0.08, -0.139)], [90.0, 30.0, 150.0]),
    ("climber", [(0.0, 0.1), (0.0, -0.1), (-0.112, 0.0)], [0.0] * 3),
]


@pytest.mark.parametrize(("name", "places", "directions"), WHEELS)
def test_wheels_stand_where_the_robot_file_has_them(
    name: str, places: list[tuple[float, float]], directions: list[float]
) -> None:
    body, *wheels = outline_of(find(name))
    assert [middle(one) for one in wheels] == places
    assert [rolls(one) for one in wheels] == directions
    assert len(body) >= 4


def test_every_robot_that_moves_in_the_plane_has_a_body() -> None:
    for name in ("rars", "rars+imu", "rome", "rome+cameras", "rome_arm", "climber", "ar2", "diff_drive"):
        outline = outline_of(find(name))
        assert outline, name
        assert all(math.isfinite(one) for polygon in outline for point in polygon for one in point)
    assert outline_of(find("servo_axis")) == []


def far(state: dict[str, Any]) -> list[float]:
    """Return the lengths of an arm's links."""
    points = state["arm"]
    return [round(math.dist(a, b), 3) for a, b in pairwise(points)]


@pytest.mark.parametrize(("robot", "mission", "foot"), [("ar2", "sine", 0.0), ("rome_arm", "orbit", None)])
def test_an_arm_is_where_its_joints_are_counted(robot: str, mission: str, foot: float | None) -> None:
    with shown(robot, mission) as bench:
        bench.opens()
        states: list[dict[str, Any]] = []
        for _ in range(20):
            bench.runs(500)
            states.append(bench.state())
        geometry = bench.rig.robot.geometry
        height = geometry.balance.arm_height_m if foot is None else foot
        tools = {tuple(state["arm"][-1]) for state in states}
        for state in states:
            # Shoulder, upper arm, forearm and tool of the AR2's links; the other joints are in one place.
            assert far(state) == [0.182, 0.305, 0.0, 0.223, 0.0, 0.036]
            assert state["arm"][0] == [0.0, 0.0, pytest.approx(height)]
        assert len(tools) > 5, "the mission moves the tool"


def test_a_robot_without_an_arm_has_none() -> None:
    with shown("rome", "line") as bench:
        bench.opens()
        assert bench.state()["arm"] == []


def test_a_recording_shows_the_robot_that_it_names_where_that_is_installed() -> None:
    assert outline_named("rars") == outline_of(find("rars"))
    assert outline_named("no_such_robot") == outline_named("") == []
