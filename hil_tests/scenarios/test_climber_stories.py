"""The climber on the bench: closed paths by captured pose and by odometry, joint, coupled wheels, a fall."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.path_error import path_error
from emulators.run import RunOrder, followed
from emulators.testing.inherited.scripted import mission_of, scripted
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds
from validation.climber.constraints import Robot
from validation.climber.plant import Way, sizes

CLOSED = ("square", "triangle", "diamond")
PAGE = Path(__file__).parents[2] / "docs" / "climber.md"
STOP_DEG, BOUND_DEG = 25.0, 15.0


class Ridden:
    """A mission that was driven: its figures, its largest distance from the path, and what held."""

    def __init__(self, robot: AnyRobot, name: str, until_s: float | None = None, seed: int = 0) -> None:
        bench_setup, mission = bench_setup_of(robot), mission_of(robot, name)
        with scripted(robot, mission, stream=seed, seed=seed) as rig:
            rig.run(from_seconds(mission.duration_s if until_s is None else until_s))
            order = RunOrder(robot, bench_setup, name, mission, seed, None)  # type: ignore[arg-type] # no files
            self.path = path_error(rig.samples, followed(order), 0.0)
            reported = {key: figure(rig.samples) for key, figure in bench_setup.figures.items()}
            self.figures = {key: math.nan if it is None else it for key, it in reported.items()}
            self.held = {
                event.name: event.reason for event in rig.interlock_events if event.began > from_seconds(4.0)
            }
            self.samples = rig.samples
            self.refused = rig.guard.refused

    def row(self, title: str) -> str:
        """Return its row of the page's table."""
        assert self.path.same_instant is not None
        off_mm, closure_mm = 1e3 * self.path.same_instant, 1e3 * self.figures["closure_m"]
        joint_deg = self.figures["max_joint_deg"]
        return f"| {title} | {off_mm:.1f} mm | {closure_mm:.1f} mm | {joint_deg:.1f} degrees |"

    def open_row(self, title: str, result: str) -> str:
        """Return its row of the page's table of open loops."""
        return f"| {title} | {result} | {self.figures['max_joint_deg']:.1f} degrees |"

    def way(self) -> tuple[np.ndarray, np.ndarray]:
        """Return arc and height while the path follower drove."""
        followed_by = np.isfinite(self.samples.column("path_offset_s"))
        return self.samples.column("x_m")[followed_by], self.samples.column("y_m")[followed_by]


def changed(table: str, **values: Any) -> AnyRobot:
    """Return the climber with other values in one table of its geometry."""
    robot = find("climber")
    geometry = robot.geometry
    other = getattr(geometry, table).model_copy(update=values)
    return robot.model_copy(update={"geometry": geometry.model_copy(update={table: other})})


@pytest.mark.long(beside="test_where_a_magnet_lets_go_it_states_so_and_the_drives_stop")
@pytest.mark.parametrize("name", CLOSED)
def test_by_captured_pose_a_closed_path_is_kept_to_and_closes(name: str) -> None:
    ridden = Ridden(find("climber+cameras"), name)
    assert ridden.path.same_instant is not None
    assert ridden.path.same_instant < 0.020
    assert ridden.figures["closure_m"] < 0.001
    assert ridden.figures["max_joint_deg"] < BOUND_DEG
    assert ridden.refused == 0
    # The mission's own end disarms; nothing else holds while it drives.
    assert set(ridden.held) == {"not armed"}
    assert ridden.row(f"{name}, cameras") in PAGE.read_text(encoding="utf-8")


@pytest.mark.long(beside="test_where_a_magnet_lets_go_it_states_so_and_the_drives_stop")
@pytest.mark.parametrize("name", CLOSED)
def test_by_odometry_alone_it_is_off_by_what_the_summary_reports(name: str) -> None:
    ridden = Ridden(find("climber"), name)
    assert 0.001 < ridden.figures["closure_m"] < 0.03
    assert ridden.figures["max_joint_deg"] < BOUND_DEG
    assert ridden.row(f"{name}, odometry alone") in PAGE.read_text(encoding="utf-8")


@pytest.mark.long(beside="test_where_a_magnet_lets_go_it_states_so_and_the_drives_stop")
@pytest.mark.parametrize("name", CLOSED)
def test_without_the_rule_the_same_paths_touch_the_joints_stop(name: str) -> None:
    free = changed("joint", turns_round_deg=80.0, slow_deg=80.0, bound_deg=85.0, sensor_bound_deg=90.0)
    assert Ridden(free, name).figures["max_joint_deg"] > STOP_DEG


@pytest.mark.long(beside="test_where_a_magnet_lets_go_it_states_so_and_the_drives_stop")
def test_coupled_it_cannot_turn_round_and_the_rule_stops_it() -> None:
    robot = changed("base", coupled=True)
    paths = robot.geometry.paths.model_copy(update={"length_m": 2.0})
    robot = robot.model_copy(update={"geometry": robot.geometry.model_copy(update={"paths": paths})})
    ridden = Ridden(robot, "vertical", until_s=29.5)
    assert "nose first" in ridden.held["joint limit"]
    assert ridden.figures["max_joint_deg"] < BOUND_DEG
    turned = ridden.samples.column("heading_rad")
    assert np.abs(turned - turned[0]).max() < math.radians(1.0)
    last = ridden.samples[-1]
    assert last["y_m"] == pytest.approx(1.2, abs=0.1)


def test_where_a_magnet_lets_go_it_states_so_and_the_drives_stop() -> None:
    ridden = Ridden(find("climber"), "falls")
    assert ridden.held["off the wall"] == "0% of its magnets are on the wall"
    # g t^2 / 2 from within some 0.1 s of the fault at 9 s until 14 s.
    assert ridden.figures["fell_m"] == pytest.approx(0.5 * 9.81 * 4.95**2, rel=0.05)
    speed = ridden.samples.column("speed_mps")
    assert np.abs(speed[-300:]).max() < 1e-3


OPEN = {"open_vertical": ("vertical, 1 m", 90.0), "open_horizontal": ("horizontal, 1 m", 0.0)}
OPEN |= {"open_spiral": ("at 45 degrees, 1 m", 45.0)}


@pytest.mark.long(beside="test_where_a_magnet_lets_go_it_states_so_and_the_drives_stop")
@pytest.mark.parametrize("name", OPEN)
def test_straight_on_in_open_loop_it_drifts_by_what_the_page_states(name: str) -> None:
    """Qualls et al., JAMRIS 10(3), 2016, case 1: the chassis's speed and turn rate are held."""
    ridden, (title, heading_deg) = Ridden(find("climber"), name), OPEN[name]
    assert set(ridden.held) == {"not armed"}
    arc, height = ridden.way()
    course = math.radians(heading_deg)
    arc, height = arc - arc[0], height - height[0]
    assert arc[-1] * math.cos(course) + height[-1] * math.sin(course) == pytest.approx(1.0, abs=0.03)
    aside = 1e3 * float(height[-1] * math.cos(course) - arc[-1] * math.sin(course))
    assert ridden.open_row(title, f"{aside:+.1f} mm to the left") in PAGE.read_text(encoding="utf-8")


@pytest.mark.long(beside="test_where_a_magnet_lets_go_it_states_so_and_the_drives_stop")
@pytest.mark.parametrize(
    ("name", "heading_deg", "way", "title"),
    [
        ("open_circle", 0.0, 1.0, "circle, put on looking round the tank"),
        ("open_circle_back", 90.0, -1.0, "circle tail first, put on looking up"),
    ],
)
def test_a_circle_by_the_chassis_s_speeds_is_that_of_exact_rolling(
    name: str, heading_deg: float, way: float, title: str
) -> None:
    """Case 1: as oblong as the constraints have it; it closes within a hundredth of its diameter."""
    ridden = Ridden(changed("start", heading_deg=heading_deg), name)
    assert set(ridden.held) == {"not armed"}
    arc, height = ridden.way()
    ratio = float(np.ptp(arc) / np.ptp(height))
    p, seconds = sizes("driven"), 20.0 * math.pi
    caster = math.pi if way < 0.0 else 0.0
    robot = Robot.standing(p, math.radians(heading_deg), caster)
    ways = robot.steered(way * 0.05, 0.1, seconds, seconds / 240)
    exact = Way.of([each.readings() for each in ways], p["tank_radius"])
    assert ratio == pytest.approx(exact.width_over_height(), abs=0.003)
    closure = ridden.figures["closure_m"]
    assert closure == pytest.approx(exact.gap(), abs=0.003)
    assert closure < 0.01
    joint = math.degrees(float(np.abs(exact.joint).max()))
    assert ridden.figures["max_joint_deg"] == pytest.approx(joint, abs=0.1)
    result = f"closes to {1e3 * closure:.1f} mm, width over height {ratio:.3f}"
    assert ridden.open_row(title, result) in PAGE.read_text(encoding="utf-8")


@pytest.mark.long(beside="test_where_a_magnet_lets_go_it_states_so_and_the_drives_stop")
def test_nose_first_from_a_turned_joint_a_circle_ends_at_the_joint_limit() -> None:
    """Put on looking up, it turns on the spot to the start, and its joint is turned already."""
    ridden = Ridden(find("climber"), "open_circle")
    assert "nose first" in ridden.held["joint limit"]
    assert ridden.figures["max_joint_deg"] < STOP_DEG
    assert ridden.figures["closure_m"] > 0.5
