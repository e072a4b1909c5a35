"""The program as a user meets it: help, version, the robots, and one clear message for each mistake."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from firmware_bridge import robot_types
from firmware_bridge.cli import program
from firmware_bridge.robots.rars import ROBOT_TYPE


def run(*words: str, columns: int = 200) -> tuple[int, str, str]:
    plain = {"COLUMNS": str(columns), "TERM": "dumb", "NO_COLOR": "1"}
    result = CliRunner().invoke(program, list(words), env=plain)
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.stdout, result.stderr


def rars_with(folder: Path, old: str, new: str) -> str:
    """Write the robot file of RARS with one change, and return its path."""
    text = ROBOT_TYPE.file.read_text(encoding="utf-8")
    assert old in text
    changed = folder / "changed.toml"
    changed.write_text(text.replace(old, new, 1), encoding="utf-8")
    return str(changed)


def test_help_names_every_command_with_an_example() -> None:
    status, out, _ = run("--help")
    assert status == 0
    for command in ("bench", "drive", "emulate", "robots"):
        assert re.search(rf"^  {command} ", out, flags=re.MULTILINE), out
    assert "bench rars --mission circles" in out


@pytest.mark.parametrize("command", ["bench", "drive", "emulate", "robots"])
def test_each_command_explains_itself_with_an_example(command: str) -> None:
    status, out, _ = run(command, "--help")
    assert status == 0
    assert f"firmware-bridge {command}" in out


def test_version() -> None:
    status, out, _ = run("--version")
    assert status == 0
    assert re.fullmatch(r"firmware-bridge \d+\.\d+\.\d+\n", out)


@pytest.mark.parametrize("columns", [80, 120, 200])
def test_robots_is_a_line_for_each_robot(columns: int) -> None:
    status, out, err = run("robots", columns=columns)
    assert (status, err) == (0, "")
    lines = [line.split() for line in out.splitlines() if " good " in f"{line} "]
    assert [line[0] for line in lines] == list(robot_types.robots())
    assert ["rars", "4", "good", "epos2-can"] in [line[:4] for line in lines]
    assert max(map(len, out.splitlines())) <= columns


@pytest.mark.parametrize("columns", [80, 120, 200])
def test_robots_shows_one_in_full(columns: int) -> None:
    status, out, err = run("robots", "rars", "rome", columns=columns)
    assert (status, err) == (0, "")
    for row in ("1 left rear wheel", "2 right rear wheel", "3 steering", "4 scissor lift"):
        assert row in out
    # What each firmware reads, and what a reversal takes of its cycle; cells may be wrapped.
    together = " ".join(out.split())
    for row in ("mw: 2 encoders", "ros-arduino-bridge: 3", "firmata: 2 encoders", "reversal"):
        assert row in together
    status, _, err = run("robots", "climbr")
    assert (status, "climbr: no such robot; perhaps 'climber'" in err) == (2, True)


@pytest.mark.parametrize("columns", [80, 120, 200])
def test_robots_names_a_weaker_check_once(columns: int) -> None:
    _, out, _ = run("robots", "ar2", columns=columns)
    assert out.count("position not changing") == 1
    assert out.count("all axes, which lack a report:") == 1
    assert len(out.splitlines()) < 30


def test_robots_checks_the_files_that_it_is_given(tmp_path: Path) -> None:
    status, out, err = run("robots", rars_with(tmp_path, "node = 2", "node = 1"))
    assert status == 2
    assert "wrong" in out
    assert "axes[1].settings.node: 1 is the node of axes[0], too" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("old", "new", "messages"),
    [
        ("[battery]", "[battery", ["not valid TOML: "]),
        ("node = 2", "node = 1", ["axes[1].settings.node: 1 is the node of axes[0], too\n"]),
        (
            "wheel_radius_m",
            "wheel_radius",
            [
                "geometry.base.wheel_radius_m: is missing\n",
                "geometry.base.wheel_radius: no such key; perhaps 'wheel_radius_m'?\n",
            ],
        ),
        ("cycle_ms = 50", "cycle_ms = 0", ["cycle_ms: Input should be greater than or equal to 5, "]),
    ],
)
@pytest.mark.parametrize("command", ["bench", "drive", "emulate"])
def test_a_wrong_robot_file_is_refused_by_file_and_key(
    tmp_path: Path, command: str, old: str, new: str, messages: list[str]
) -> None:
    path = rars_with(tmp_path, old, new)
    status, _, err = run(command, path)
    assert status == 2
    lines = err.removeprefix("firmware-bridge: ").splitlines(keepends=True)
    assert len(lines) == len(messages), "a line for each mistake"
    for line, message in zip(lines, messages, strict=True):
        assert line.startswith(f"{path}: {message}")


@pytest.mark.parametrize("command", ["bench", "drive"])
def test_an_unknown_robot_is_answered_with_those_that_there_are(command: str) -> None:
    assert run(command, "r2d2") == (
        2,
        "",
        (
            f"firmware-bridge: r2d2: no such robot; there are: {', '.join(robot_types.names())}"
            " (a path to a .toml file works, too)\n"
        ),
    )
