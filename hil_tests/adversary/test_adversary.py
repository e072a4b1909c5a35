"""The adversary finds nothing; and what it is there to find, it finds, and shrinks to what matters."""

from pathlib import Path
from typing import Final

import pytest

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from firmware_bridge.bridge.joint_state import Event
from firmware_bridge.bridge.permission import Permission
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from hil_tests.adversary.__main__ import main
from hil_tests.adversary.failing import FaultProfile
from hil_tests.adversary.mutants import TARGETS, tool
from hil_tests.adversary.robots import read, robot_of
from hil_tests.adversary.search import Found, Search, as_toml
from hil_tests.adversary.truth import invariants

ROBOTS: Final = {
    "rars": 7,
    "rars --serial v2": 7,
    "diff_drive": 7,
    "rome": 2,
    "rome --protocol arduinoio --encoders 3": 2,
    "rome --protocol mw --encoders 3": 2,
    "rome+cameras": 1,
    "rome+cameras --protocol arduinoio": 1,
    "rome+cameras --protocol mw": 1,
    "rome+cameras --protocol firmata": 2,
    "ar2": 3,
    "rome_arm": 2,
    "climber": 5,
    "climber+cameras": 2,
    "servo_axis": 7,
}
"""Arguments of `bench`, with the number of random runs of each.

Over Firmata two wheels of three are counted, so that it needs the cameras.
"""
FOUND: Final = sorted(Path(__file__).with_name("found").glob("*.toml"))
"""Missions that broke a rule once, or the bench."""
TOUCHES: Final = (7, 14, 19, 28, 33)
"""Random runs in which a climber without its rule touches its joint's stop, as in one of eight.

A hair's breadth more or less decides if a run still does: one of them is enough.
"""
HONEST: Final = frozenset({FaultProfile.HONEST})
ALL: Final = frozenset(FaultProfile)


def search(robot: AnyRobot, natures: frozenset[FaultProfile], judged: AnyRobot | None = None) -> Search:
    return Search(robot, bench_setup_of(robot), invariants(judged or robot), natures)


@pytest.mark.long(beside="test_an_emergency_stop_that_does_nothing_is_found")
@pytest.mark.parametrize("natures", [HONEST, ALL], ids=["honest", "all"])
@pytest.mark.parametrize(
    ("line", "seed"), [(line, seed) for line, evenings in ROBOTS.items() for seed in range(evenings)]
)
def test_no_random_run_breaks_a_rule(line: str, natures: frozenset[FaultProfile], seed: int) -> None:
    found, _ = search(robot_of(read(line)), natures).random_run(seed)
    assert found is None, as_toml(found, line)


@pytest.mark.long(beside="test_an_emergency_stop_that_does_nothing_is_found")
@pytest.mark.parametrize("file", FOUND, ids=lambda file: file.stem)
def test_what_was_found_once_is_not_found_again(file: Path) -> None:
    robot = robot_of(read(_line_of(file)))
    one = search(robot, ALL)
    mission = missions.load(file, robot, one.bench_setup)
    assert one.breaks(mission, seed=0) is None


def _line_of(file: Path) -> str:
    """Return the robot that the file's second line names, as arguments of `bench`."""
    return file.read_text(encoding="utf-8").splitlines()[1].partition(" bench ")[2]


def found_by(one: Search, seeds: int) -> Found:
    """Return what the first of these random runs with a finding has found."""
    return next(found for found, _ in map(one.random_run, range(seeds)) if found is not None)


@pytest.mark.long(beside="test_an_emergency_stop_that_does_nothing_is_found")
def test_a_limit_that_is_too_high_is_found_and_driven_again_from_its_file() -> None:
    """And no one behind it: the guard knows no sum."""
    rars = find("rars")
    limits = rars.geometry.limits.model_copy(update={"speed_mps": 0.6})
    geometry = rars.geometry.model_copy(update={"limits": limits})
    robot = rars.model_copy(
        update={"geometry": geometry, "guard": rars.guard.model_copy(update={"sums": ()})}
    )
    one = search(robot, HONEST, rars)
    found = found_by(one, 8)
    assert found.violation.name in {"base speed beyond its bound", "speed beyond its limit"}
    assert len(found.mission.step) <= 4
    assert found.mission.fault == ()
    text = as_toml(found, "rars")
    again = missions.parse(text, "found.toml", robot, one.bench_setup)
    broken = one.again(again, found.seed, found.violation.name)
    assert broken == found.violation


@pytest.mark.long(keeps=["climber"])
@pytest.mark.parametrize("line", ["climber", "climber+cameras"])
def test_a_climber_without_its_joints_rule_touches_the_stop(line: str) -> None:
    """In random runs that the rule keeps from it: backwards, with the joint bent to the other side."""
    climber = find(line)
    free = {"turns_round_deg": 80.0, "slow_deg": 80.0, "bound_deg": 85.0, "sensor_bound_deg": 90.0}
    joint = climber.geometry.joint.model_copy(update=free)
    geometry = climber.geometry.model_copy(update={"joint": joint})
    free_one = search(climber.model_copy(update={"geometry": geometry}), HONEST)
    found = next(found for found, _ in map(free_one.looked, TOUCHES) if found is not None)
    assert found.violation.name == "its joint at the stop"
    ruled, _ = search(climber, HONEST).looked(found.seed)
    assert ruled is None


@pytest.mark.long(beside="test_an_emergency_stop_that_does_nothing_is_found")
def test_an_arm_that_is_reported_too_much_loses_its_steps() -> None:
    """With limits that its motors cannot follow: only the plant shows it."""
    arm = find("ar2")
    limits = arm.geometry.limits.model_copy(update={"speed_mps": 0.04})
    geometry = arm.geometry.model_copy(update={"limits": limits})
    axes = tuple(axis.model_copy(update={"top_speed": 0.25}) for axis in arm.axes)
    links = {name: link.model_copy(update={"move_ms": 60}) for name, link in arm.links.items()}
    hasty = arm.model_copy(update={"geometry": geometry, "axes": axes, "links": links})
    found = next(found for found, _ in map(search(hasty, HONEST).looked, range(8)) if found is not None)
    assert found.violation.name == "steps lost"


@pytest.mark.interpreted
def test_an_emergency_stop_that_does_nothing_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    happens = Permission.happens

    def no_stop(permission: Permission, event: Event) -> None:
        if event is not Event.STOP:
            happens(permission, event)

    monkeypatch.setattr(Permission, "happens", no_stop)
    one = search(find("diff_drive"), HONEST)
    found = next(found for found, _ in map(one.looked, (44,)) if found is not None)
    assert found.violation.name == "motion with power that may not be"
    assert any(step.emergency_stop for step in found.mission.step)


def test_the_mutants_are_of_modules_that_there_are() -> None:
    assert all(next(tool().mutants(target), None) is not None for target in TARGETS)


def test_the_command_of_the_night_searches_with_all_its_options(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = [
        "diff_drive",
        "--hours",
        "1e-6",
        "--profiles",
        "honest",
        "lying",
        "--seed",
        "7",
        "--out",
        str(tmp_path),
    ]
    monkeypatch.setattr("sys.argv", ["adversary", *words])
    assert main() == 0
    printed = capsys.readouterr().out
    assert "simulated hours, seeds 7 to 7, 1 of " in printed
    assert printed.endswith("joint states x fault kinds, 0 found\n")


def test_a_robot_that_there_is_not_is_one_line_and_no_find(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["adversary", "mars"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2, "1 states that something was found"
    assert "mars: no such robot; perhaps 'rars'?" in capsys.readouterr().err
