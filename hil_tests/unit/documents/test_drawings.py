"""The drawings of the robots: in step with the robot files, and readable on a dark page."""

import re
from collections.abc import Mapping
from html import unescape
from typing import Any

import pytest

from firmware_bridge.robot_types import find
from validation.pages.drawings import DRAWINGS, FOLDER

GROUND = re.compile(r'<rect width="([\d.]+)" height="([\d.]+)" fill="#FFFFFF"/>')
USED: Mapping[str, tuple[str, ...]] = {
    "rars": (
        "base.wheel_radius_m",
        "base.rear_track_m",
        "base.wheelbase_m",
        "base.kingpin_distance_m",
        "base.half_support_width_m",
        "base.centre_of_gravity_height_m",
        "lift.link_length_m",
        "lift.extended_angle_deg",
        "limits.turn_radius_m",
    ),
    "rome": ("base.wheel_radius_m", "base.wheel_distance_m"),
    "rome_arm": (
        "base.base.wheel_radius_m",
        "base.base.wheel_distance_m",
        "balance.base_kg",
        "balance.arm_height_m",
        "balance.margin_m",
        "balance.tool_distance_m",
    ),
    "ar2": (
        "workspace.lowest_m",
        "workspace.highest_m",
        "workspace.base_radius_m",
        "workspace.base_height_m",
        "limits.joint_margin_deg",
    ),
    "climber": (
        "base.wheel_radius_m",
        "base.track_m",
        "base.crown_radius_m",
        "tank.radius_m",
        "joint.bound_deg",
        "wall.length_m",
        "wall.mass_height_m",
    ),
    "servo_axis": ("limits.speed", "limits.acceleration"),
}


def enlarged(table: Any, keys: list[str]) -> Any:
    """Return a copy of a table with one number larger by a tenth."""
    key, *more = keys
    before = getattr(table, key)
    if more:
        after = enlarged(before, more)
    else:
        after = tuple(1.1 * it for it in before) if isinstance(before, tuple) else 1.1 * before
    return table.model_copy(update={key: after})


def texts(drawing: str) -> list[str]:
    return [unescape(it) for it in re.findall(r"<text [^>]*>([^<]*)</text>", drawing)]


@pytest.mark.parametrize("name", DRAWINGS)
def test_the_committed_drawing_is_the_one_of_the_robot_file(name: str) -> None:
    committed = (FOLDER / f"{name}.svg").read_text(encoding="utf-8")
    hint = "the robot file has changed: python -m validation.pages.drawings"
    assert DRAWINGS[name](find(name)) == committed, hint


@pytest.mark.parametrize(("name", "key"), [(name, key) for name, keys in USED.items() for key in keys])
def test_another_number_in_the_geometry_gives_another_drawing(name: str, key: str) -> None:
    robot = find(name)
    changed = robot.model_copy(update={"geometry": enlarged(robot.geometry, key.split("."))})
    assert DRAWINGS[name](changed) != DRAWINGS[name](robot)


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_drawing_has_a_white_ground_and_stays_on_it(name: str) -> None:
    drawing = DRAWINGS[name](find(name))
    _, _, ground, *_ = drawing.splitlines()
    size = GROUND.fullmatch(ground)
    assert size is not None
    width, height = map(float, size.groups())
    assert f'viewBox="0 0 {width:g} {height:g}"' in drawing
    for points in re.findall(r'points="([^"]+)"', drawing):
        for point in points.split():
            x, y = map(float, point.split(","))
            assert 0.0 <= x <= width
            assert 0.0 <= y <= height


@pytest.mark.parametrize(
    ("name", "dimensions"),
    [
        ("rars", {"wheelbase 515", "rear track 400", "kingpins 210", "50", "168", "190", "travel 1115.9"}),
        ("rome", {"160", "80", "between wheels 277.1", "50"}),
        ("rome_arm", {"160", "150", "450", "upper arm 305", "forearm 222.6"}),
        ("ar2", {"1320", "workspace 780", "250", "130", "169.8", "64.2", "upper arm 305"}),
        ("climber", {"track 200", "111.5", "radius 50", "tank radius 2000", "joint, limit ±15°"}),
    ],
)
def test_dimensions_are_in_millimeters(name: str, dimensions: set[str]) -> None:
    assert dimensions <= set(texts(DRAWINGS[name](find(name))))


def test_every_sensor_and_axis_of_the_climber_is_named() -> None:
    robot = find("climber")
    words = " ".join(texts(DRAWINGS["climber"](robot)))
    for name in (*(it.title for it in robot.sensors), *(it.title for it in robot.axes)):
        assert name in words
