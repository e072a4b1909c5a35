"""The robot's missions on the bench; the safety tests come with firmware-bridge, for every robot."""

from pathlib import Path

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.summary import Summary
from emulators.run import RunOrder, drive
from firmware_bridge.robot_types import find


def driven(name: str, folder: Path) -> Summary:
    """Drive a mission and return its numbers."""
    robot = find("diff_drive")
    bench_setup = bench_setup_of(robot)
    mission = missions.find(name, robot, bench_setup)
    return drive(RunOrder(robot, bench_setup, name, mission, 0, folder), lambda _: None)


def test_it_drives_the_line(tmp_path: Path) -> None:
    summary = driven("line", tmp_path)
    assert 0.0 < summary.max_speed_mps <= find("diff_drive").geometry.limits.speed_mps
    assert summary.path_length_m > 0.0
    assert summary.odometry_error_m < 0.05 * summary.path_length_m


def test_the_guide_comes_back_to_where_the_circles_touch(tmp_path: Path) -> None:
    summary = driven("figure_eight", tmp_path)
    assert not [event for event in summary.interlock_events if event.name == "turns too fast"]
    assert summary.odometry_error_m < 0.05 * summary.path_length_m
