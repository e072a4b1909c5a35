"""A failed steering: goals that the rear wheels reach against the stuck rack, by the plant (thesis 2.2)."""

import math
from pathlib import Path
from typing import Final

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import Mission, MissionFileError, parse
from emulators.bench.summary import Summary
from emulators.run import RunOrder, drive
from firmware_bridge.robot_types import find

CAMERAS_M: Final = 0.10
ODOMETRY_M: Final = 0.30
FLOORS: Final = (0.3, 0.6)
SCRIPT: Final = """
title = "A goal with a stuck rack"
duration_s = {ends}
plant = {{ floor_friction = {floor} }}
[pilot]
path = "goal"
goal_m = [{ahead}, {left}]
loop = {loop}
speed_mps = 0.2
look_ahead_m = 0.8
begins_s = 11.0
[[step]]
at_s = 0.0
title = "confirm the positions"
zero = {{ steering = 0.0, lift = 0.0 }}
[[step]]
at_s = 3.0
title = "arm"
arm = true
[[step]]
at_s = 4.0
title = "steer"
steer_deg = {stuck}
[[step]]
at_s = 6.5
title = "disarm"
disarm = true
[[step]]
at_s = 8.0
title = "set the mode"
mode = "steering_failed"
[[step]]
at_s = 9.0
title = "neutral"
steer_deg = 0.0
[[step]]
at_s = 12.0
title = "arm; the pilot drives"
arm = true
"""


def driven(
    folder: Path, name: str, goal: tuple[float, float], stuck: float, floor: float = 0.3, **how: object
) -> tuple[Summary, tuple[float, float]]:
    """Return the summary of a run, and where it ended by the plant, ahead and left of where it began."""
    robot = find(name)
    setup = bench_setup_of(robot)
    values = {
        "ahead": goal[0],
        "left": goal[1],
        "stuck": stuck,
        "floor": floor,
        "loop": "false",
        "ends": 50.0,
    }
    mission: Mission = parse(SCRIPT.format(**values | how), "goal.toml", robot, setup)
    order = RunOrder(robot, setup, "goal", mission, 0, folder)
    summary = drive(order, lambda _: None)
    lines = (folder / "samples.csv").read_text(encoding="ascii").splitlines()
    place = dict(zip(lines[0].split(","), map(float, lines[-1].split(",")), strict=True))
    return summary, (place["x_m"], place["y_m"])


@pytest.mark.long(keeps=["goal0-0.0-0.3-rars+cameras", "goal2-10.0-0.6-rars"])
@pytest.mark.parametrize("name", ["rars", "rars+cameras"])
@pytest.mark.parametrize("floor", FLOORS)
@pytest.mark.parametrize(
    ("goal", "stuck"),
    [((5.0, 0.5), 0.0), ((5.0, -0.5), 0.0), ((3.0, 1.5), 10.0), ((3.0, -1.5), -10.0)],
)
def test_a_goal_is_reached_by_the_wheels(
    tmp_path: Path, name: str, floor: float, goal: tuple[float, float], stuck: float
) -> None:
    _, end = driven(tmp_path, name, goal, stuck, floor)
    assert math.dist(end, goal) < (CAMERAS_M if name == "rars+cameras" else ODOMETRY_M)


def test_a_goal_on_the_other_side_is_refused_with_the_space_that_a_loop_needs(tmp_path: Path) -> None:
    with pytest.raises(MissionFileError, match=r"only a loop leads there, 1\d\.\d m long, from -\d\.\d to "):
        driven(tmp_path, "rars", (3.0, -1.5), 10.0, ends=20.0)


@pytest.mark.long(beside="test_a_goal_on_the_other_side_is_refused_with_the_space_that_a_loop_needs")
def test_a_loop_that_is_allowed_leads_there(tmp_path: Path) -> None:
    _, end = driven(tmp_path, "rars+cameras", (3.0, -1.5), 10.0, loop="true", ends=125.0)
    assert math.dist(end, (3.0, -1.5)) < CAMERAS_M
