"""The margin that an operator sees: on the link, on the live page, and in a run's results."""

import csv
import math
from pathlib import Path

import pytest

from emulators.bench import margin
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import find as mission_of
from emulators.run import RunOrder, drive
from firmware_bridge.live.plotted import values_of
from firmware_bridge.live.state import bridge_state
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find, robot_type_of
from firmware_bridge.teleop.streams import streams_of
from hil_tests.scenarios.ride import ARMED, SETTLED_S, ride
from hil_tests.stability.manoeuvres import robot as tipping

SOME_S, WHOLE_S = 6.0, math.inf
CLIMBER, ROME_ARM = find("climber"), find("rome_arm")


def names(robot: AnyRobot) -> set[str]:
    """Return the names of the values that a robot sends."""
    return {one.title.partition(":")[0] for one in streams_of(robot, robot_type_of(robot).station)}


@pytest.mark.parametrize(("robot", "has"), [(CLIMBER, True), (ROME_ARM, True), (find("rars"), False)])
def test_it_is_sent_by_robots_that_have_one(robot: AnyRobot, *, has: bool) -> None:
    assert ("MARGIN" in names(robot)) is has
    assert bool(margin.columns(robot)) is bool(margin.panels(robot)) is has


def test_a_climbers_margin_is_the_least_at_the_height_that_its_adhesion_allows() -> None:
    wall = CLIMBER.geometry.wall
    assert wall.margin(wall.highest_m) == pytest.approx(wall.least_margin)
    assert wall.margin(0.0) == wall.margin(-1.0) == pytest.approx(wall.held_n / (wall.mass_kg * 9.81))
    heights = [0.1 * step for step in range(200)]
    margins = [wall.margin(height) for height in heights]
    assert margins == sorted(margins, reverse=True)


def test_what_a_page_and_a_plotter_receive_is_the_margin_and_its_least() -> None:
    one = ride(ARMED, seconds=8.0, robot=tipping(governed=True))
    try:
        one.runs_until(SETTLED_S)
        state = bridge_state(one.rig.robot, one.rig.bridge)
        shown = state["margin"]
        assert (shown["least"], shown["unit"]) == (10.0, "mm")
        # On the level the height of the load does not count; the IMU's noise is some tenths of a degree.
        assert shown["value"] == pytest.approx(1000.0 * one.rig.devices.plant.read("zmp_margin"), abs=3.0)
        plotted = values_of({**state, "at_s": 1.0})["margin"]
        assert plotted == {"value": shown["value"], "least": 10.0}
    finally:
        one.rig.finish()


@pytest.mark.long(keeps=["climber-square-margin_times-6.0", "rome_arm-orbit-margin_mm-6.0"])
@pytest.mark.parametrize("seconds", [SOME_S, WHOLE_S])
@pytest.mark.parametrize(
    ("robot", "mission", "column"),
    [("climber", "square", "margin_times"), ("rome_arm", "orbit", "margin_mm")],
)
def test_a_run_has_it_in_its_samples(
    robot: str, mission: str, column: str, seconds: float, tmp_path: Path
) -> None:
    machine = find(robot)
    setup = bench_setup_of(machine)
    whole = mission_of(mission, machine, setup)
    driven = min(seconds, whole.duration_s)
    steps = tuple(step for step in whole.step if step.at_s < driven)
    script = whole.model_copy(update={"duration_s": driven, "step": steps})
    order = RunOrder(machine, setup, mission, script, 0, tmp_path)
    drive(order, lambda _: None)
    row = margin.margin_of(machine)
    assert row is not None
    with (tmp_path / "samples.csv").open(encoding="utf-8") as file:
        kept = [float(one[column]) for one in csv.DictReader(file)]
    known = [one for one in kept if math.isfinite(one)]
    assert len(known) > 100
    # No shipped mission comes near to what its limits keep.
    assert min(known) > (row.least(machine) or 0.0)
