"""`new --kind axis`: one command writes the file, the next one drives it; what is no axis is refused."""

import math
from collections.abc import Sequence
from pathlib import Path

import pytest
from typer.testing import CliRunner

from emulators.testing.rig import VirtualRig
from firmware_bridge.cli import program
from firmware_bridge.robot import CommandForm
from firmware_bridge.robot_types import find

TURNS = ("--gear", "26", "--inertia", "0.0875", "--motor", "RE50")
BETWEEN = ("--travel", "-0.8,1.8")
SLIDES = ("--unit", "m", "--gear", "1250", "--inertia", "8", "--speed", "0.2", "--travel", "0,0.4")
BY_SPEED = ("--command", "speed", "--speed", "5")


def new(folder: Path, *words: str) -> tuple[int, str, Path]:
    """Run the command in a folder; return its status, what it has printed, and the file."""
    done = CliRunner().invoke(program, ["new", "mine", "--kind", "axis", "--dir", str(folder), *words])
    return done.exit_code, done.output, folder / "mine.toml"


@pytest.mark.parametrize("family", ["cia402", "epos2"])
@pytest.mark.parametrize(
    "words", [(*TURNS, *BETWEEN), SLIDES, (*TURNS, *BY_SPEED)], ids=["turns", "slides", "by speed"]
)
def test_what_is_written_drives_at_once_and_stops(tmp_path: Path, family: str, words: Sequence[str]) -> None:
    status, printed, file = new(tmp_path, "--family", family, *words)
    assert status == 0, printed
    assert f"next: firmware-bridge bench {file}" in printed
    robot = find(str(file), plant_too=True)
    limit = robot.geometry.limits.speed
    rig = VirtualRig(robot)
    rig.bench.runs(4.0)
    assert rig.operator.armed
    rig.operator.does("jogs", stick=0.3)
    rig.bench.runs(1.0)
    way = rig.bench.samples[-1]["x_m"]
    assert 0.1 * limit < way < 0.4 * limit
    if robot.axes[0].command is CommandForm.POSITION:
        rig.operator.does("goes", share=1.0)
        rig.bench.runs(6.0)
        (axis,) = robot.axes
        assert axis.travel is not None
        assert math.isclose(rig.bench.samples[-1]["x_m"], axis.travel[1], abs_tol=0.02 * limit)
    rig.operator.stops()
    rig.bench.runs(3.0)
    # Without power the load rocks in its friction.
    assert abs(rig.bench.samples[-1]["speed_mps"]) < 0.15 * limit
    assert max(map(abs, rig.bench.samples.column("speed_mps"))) <= 1.1 * limit
    assert rig.bench.guard.refused == 0
    rig.bench.finish()


@pytest.mark.parametrize("unit", ["rad", "m"])
def test_a_motor_on_a_shield_drives_by_speed(tmp_path: Path, unit: str) -> None:
    """By a firmware for three motors, of which one is there."""
    words = ("--family", "motor_shield", "--command", "speed", "--voltage", "12", "--encoder-lines", "12")
    sizes = {
        "rad": ("--gear", "50", "--inertia", "0.002", "--speed", "4"),
        "m": ("--unit", "m", "--gear", "1250", "--inertia", "2", "--speed", "0.15", "--acceleration", "0.4"),
    }
    status, printed, file = new(tmp_path, *words, *sizes[unit])
    assert status == 0, printed
    robot = find(str(file), plant_too=True)
    limit = robot.geometry.limits.speed
    rig = VirtualRig(robot)
    rig.bench.runs(4.0)
    assert rig.operator.armed
    rig.operator.does("jogs", stick=0.5)
    rig.bench.runs(4.0)
    assert abs(rig.bench.samples[-1]["speed_mps"] / limit - 0.5) < 0.1
    rig.operator.stops()
    rig.bench.runs(3.0)
    # Without power the load rocks in its friction.
    assert abs(rig.bench.samples[-1]["speed_mps"]) < 0.15 * limit
    assert max(map(abs, rig.bench.samples.column("speed_mps"))) < 0.7 * limit
    assert rig.bench.guard.refused == 0
    rig.bench.finish()


@pytest.mark.parametrize(
    ("words", "stated"),
    [
        ((), "--inertia: a robot of the kind axis needs it"),
        ((*BETWEEN, "--inertia", "-1"), "--inertia must be positive, not -1"),
        (TURNS, "--command position needs --travel: LOW,HIGH in rad"),
        ((*TURNS, *BETWEEN, *BY_SPEED), "--command speed takes no --travel"),
        ((*TURNS, "--travel", "1,1"), "--travel 1,1: the first must be below the second"),
        ((*TURNS, "--travel", "1"), "--travel 1: LOW,HIGH, as -0.8,1.8"),
        (
            (*TURNS, *BETWEEN, "--family", "maxon"),
            "--family: no 'maxon'; there are: cia402, epos2, motor_shield",
        ),
        ((*TURNS, *BETWEEN, "--family", "ar2"), "--family: no 'ar2'; there are: cia402, epos2, motor_sh"),
        (
            (*TURNS, *BETWEEN, "--voltage", "12", "--family", "motor_shield"),
            "--command position: a motor on a shield goes to none; give --command speed",
        ),
        ((*TURNS, *BY_SPEED, "--family", "motor_shield"), "--voltage 24: the shield's motor supply is 4.5"),
        ((*TURNS, *BETWEEN, "--unit", "mm"), "--unit: no 'mm'"),
        ((*TURNS, *BETWEEN, "--nodes", "128"), "--nodes: one CANopen node, 1 to 127, not '128'"),
        ((*TURNS, *BETWEEN, "--speed", "50"), "take a smaller --gear, or less --speed"),
        ((*TURNS, *BETWEEN, "--motor", "no such"), "no such"),
        ((*TURNS, *BETWEEN, "--mass", "3"), "--mass: a robot of the kind axis takes no such option"),
    ],
)
def test_what_is_no_axis_is_refused_and_writes_nothing(
    tmp_path: Path, words: Sequence[str], stated: str
) -> None:
    status, printed, file = new(tmp_path, *words)
    assert status
    assert stated in printed
    assert not file.exists()


def test_a_file_that_is_there_is_kept(tmp_path: Path) -> None:
    new(tmp_path, *TURNS, *BETWEEN)
    before = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    status, printed, file = new(tmp_path, *TURNS, "--travel", "0,1")
    assert status
    assert "is there already" in printed
    assert file.read_text(encoding="utf-8") == before


def test_a_robot_of_two_wheels_still_needs_them() -> None:
    done = CliRunner().invoke(program, ["new", "mouse"])
    assert done.exit_code
    assert "--wheel-radius: a robot of the kind differential needs it" in done.output
