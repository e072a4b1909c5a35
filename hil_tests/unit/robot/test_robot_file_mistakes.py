"""A mistake in a robot file is reported by the real command line: one clear line for each, exit status 2."""

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest
from typer.testing import CliRunner, Result

from firmware_bridge.cli import program
from hil_tests.unit.robot.mistakes import BY_TITLE, MISTAKES, RARS, Mistake

LIFT = RARS[RARS.index('[[axes]]\nname = "lift"') : RARS.index("# Gains. Current")]
EXCLUSIVE = RARS[RARS.index("[[guard.exclusive]]") : RARS.index("[plant]")]
THREE_AT_ONCE = (
    ("unknown key", "unknown device", "a sum with an unknown axis"),
    ("wrong type", "unknown role", "a plant that is not installed"),
    ("missing table", "duplicate node", "unknown parameter set"),
    ("a driver that does not serve", "unknown sensor of the battery", "a travel that falls"),
    ("an axis on an unknown link", "a link without devices", "unknown key of an axis"),
)


def robots(*words: str) -> Result:
    return CliRunner().invoke(program, ["robots", *words])


def reported_of(file: Path) -> list[str]:
    """Check a file, which must be refused; return the reported problems, a line each."""
    result = robots(str(file))
    assert isinstance(result.exception, SystemExit), result.exception
    assert result.exit_code == 2
    assert "Traceback" not in result.output
    first, *others = result.stderr.splitlines()
    lines = [first.removeprefix("firmware-bridge: "), *others]
    assert all(line.startswith(f"{file}: ") for line in lines), lines
    return [line.removeprefix(f"{file}: ") for line in lines]


def written(folder: Path, text: str) -> Path:
    file = folder / "robot.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_the_file_that_the_mistakes_are_made_in_is_good(tmp_path: Path) -> None:
    assert robots(str(written(tmp_path, RARS))).exit_code == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [("velocity_rpm = 800 ", "velocity_rpm = 6_984 "), ("velocity_rpm = 2_600", "velocity_rpm = 4_000")],
)
def test_a_profile_at_its_bound_is_good(old: str, new: str, tmp_path: Path) -> None:
    assert robots(str(written(tmp_path, RARS.replace(old, new, 1)))).exit_code == 0


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.title)
def test_a_mistake_is_reported_in_one_line_with_file_key_and_what_to_do(
    mistake: Mistake, tmp_path: Path
) -> None:
    (line,) = reported_of(written(tmp_path, mistake.made_in(RARS)))
    assert line.startswith(f"{mistake.key}: ")
    assert [word for word in mistake.words if word not in line] == []


@pytest.mark.parametrize("titles", THREE_AT_ONCE, ids=" & ".join)
def test_three_mistakes_are_reported_at_once(titles: tuple[str, ...], tmp_path: Path) -> None:
    text = RARS
    for title in titles:
        text = BY_TITLE[title].made_in(text)
    lines = reported_of(written(tmp_path, text))
    assert len(lines) == len(titles)
    for title in titles:
        mistake = BY_TITLE[title]
        assert any(
            line.startswith(f"{mistake.key}: ") and all(word in line for word in mistake.words)
            for line in lines
        ), title


def test_a_robot_without_a_lift_is_no_rars(tmp_path: Path) -> None:
    """It once passed as good, and died of a KeyError."""
    lines = reported_of(written(tmp_path, RARS.replace(LIFT, "").replace(EXCLUSIVE, "")))
    assert lines == ["axes: no axis has the role 'lift', which the group 'lift' needs"]


def test_every_role_that_has_no_axis_is_reported(tmp_path: Path) -> None:
    one = RARS[: RARS.index('[[axes]]\nname = "right"')].replace(EXCLUSIVE, "")
    lines = reported_of(written(tmp_path, one[: one.index("[[guard.sums]]")] + one[one.index("[plant]") :]))
    assert [line.split("'")[1] for line in lines] == ["right_wheel", "steering", "lift"]


@pytest.mark.parametrize(
    ("content", "reported"),
    [
        (b"", "name: is missing"),
        (b"cycle_ms = 50\n", "name: is missing"),
        (b"\x7fELF\xd0\x01", "is no text in UTF-8: byte 4 is 0xD0"),
        (b"name = \n", "not valid TOML: Invalid value (at line 1, column 8)"),
        (b"name = 'rars'\nname = 'rars'\n", "not valid TOML: Cannot overwrite a value"),
        (b"deep = " + b"[" * 100_000, "not valid TOML: nested too deeply"),
        (b"long = " + b"9" * 10_000, "not valid TOML: Exceeds the limit"),
    ],
    ids=["empty", "no name", "binary", "half a line", "a key twice", "too deep", "too long a number"],
)
def test_a_file_that_is_no_robot_is_refused(content: bytes, reported: str, tmp_path: Path) -> None:
    file = tmp_path / "robot.toml"
    file.write_bytes(content)
    (line,) = reported_of(file)
    assert line.startswith(reported)


def test_a_folder_and_a_file_that_is_not_there_are_refused(tmp_path: Path) -> None:
    assert reported_of(tmp_path) == ["is a folder; name the robot file (.toml) in it"]
    assert reported_of(tmp_path / "nowhere.toml") == ["cannot be read: No such file or directory"]


def test_all_wrong_files_are_reported_in_one_run(tmp_path: Path) -> None:
    empty = written(tmp_path, "")
    result = robots(str(empty), str(tmp_path / "nowhere.toml"))
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 2


@pytest.mark.parametrize("command", ["bench", "drive", "emulate"])
def test_every_command_that_reads_a_robot_file_refuses_it(command: str, tmp_path: Path) -> None:
    file = written(tmp_path, BY_TITLE["unknown device"].made_in(RARS))
    place = () if command == "bench" else ("-i", "virtual", "-c", "mistakes")
    result = CliRunner().invoke(program, [command, str(file), *place])
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"firmware-bridge: {file}: axes[0].settings.device: ")


def test_a_plant_that_lacks_what_the_robot_needs_is_refused_by_the_bench(tmp_path: Path) -> None:
    """A name that only the robot file has: the plant takes its values, and calls its outputs, by another."""
    text = RARS.replace('name = "steer"', 'name = "rudder"')
    assert robots(str(written(tmp_path, text))).exit_code == 0
    result = CliRunner().invoke(
        program, ["bench", str(tmp_path / "robot.toml"), "--out", str(tmp_path / "out")]
    )
    assert result.exit_code == 2
    (line,) = [line for line in result.stderr.splitlines() if "building the plant" not in line]
    assert "'axes.steer.ratio'" in line
    assert "there are: left, right, rudder, lift" in line


def test_the_schema_is_one_and_takes_the_file_that_is_shipped() -> None:
    schema = json.loads(robots("--schema", "rars").stdout)
    judge = jsonschema.Draft202012Validator(schema)
    judge.check_schema(schema)
    assert list(judge.iter_errors(tomllib.loads(RARS))) == []


@pytest.mark.parametrize("title", ["unknown key", "wrong type", "missing table", "unknown device"])
def test_the_schema_refuses_what_it_can_see(title: str) -> None:
    judge = jsonschema.Draft202012Validator(json.loads(robots("--schema", "rars").stdout))
    assert list(judge.iter_errors(tomllib.loads(BY_TITLE[title].made_in(RARS))))


def test_a_schema_of_no_kind_is_refused_with_a_near_name() -> None:
    result = robots("--schema", "rasr")
    assert result.exit_code == 2
    assert result.stderr == "firmware-bridge: rasr: no such kind of robot; perhaps 'rars'?\n"
