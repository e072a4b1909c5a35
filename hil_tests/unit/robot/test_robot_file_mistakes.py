"""A mistake in a robot file is told by the real command line: one clear line for each, exit status 2."""

import json
import tomllib
from dataclasses import dataclass
from pathlib import Path

import jsonschema
import pytest
from typer.testing import CliRunner, Result

from firmware_bridge.cli import program
from firmware_bridge.kinds import kind_named

RARS = kind_named("rars").file.read_text(encoding="utf-8")
LINK = RARS[RARS.index("[links.drives]") : RARS.index("[geometry.base]")]
LIFT = RARS[RARS.index('[[axes]]\nname = "lift"') : RARS.index("# Gains. Current")]
OPERATOR = RARS[RARS.index("[operator]") : RARS.index("[battery]")]
EXCLUSIVE = RARS[RARS.index("[[guard.exclusive]]") : RARS.index("[plant]")]
OUTPUT = """
[[outputs]]
name = "{name}"
title = "a lamp"
link = "drives"
settings = {{ axis = "left", output = 1 }}
"""


@dataclass(frozen=True, slots=True)
class Mistake:
    """What is written in place of what, where it is told, and words that must be told."""

    title: str
    change: tuple[str, str]
    key: str
    words: tuple[str, ...]

    def made_in(self, text: str) -> str:
        old, new = self.change
        assert old in text, f"{self.title}: the file has no {old!r}"
        return text.replace(old, new, 1)


MISTAKES = (
    Mistake(
        "unknown key", ("cycle_ms = 50", "cycle_ms = 50\ncycel = 3"), "cycel", ("no such key", "'cycle_ms'")
    ),
    Mistake(
        "unknown key of an axis",
        ('title = "left rear wheel"', 'title = "left"\nratoi = 26.0'),
        "axes[0].ratoi",
        ("no such key", "perhaps 'ratio'?"),
    ),
    Mistake("wrong type", ("cycle_ms = 50", 'cycle_ms = "50"'), "cycle_ms", ("must be an integer", "'50'")),
    Mistake("missing table", (OPERATOR, ""), "operator", ("is missing",)),
    Mistake("missing key", ('title = "left rear wheel"\n', ""), "axes[0].title", ("is missing",)),
    Mistake(
        "a driver that does not serve",
        ('driver = "epos2-can"', 'driver = "epos2-cna"'),
        "links.drives.driver",
        ("'epos2-cna'", "perhaps 'epos2-can'?"),
    ),
    Mistake(
        "a driver of another maker",
        ('driver = "epos2-can"', 'driver = "stepper"'),
        "links.drives.driver",
        ("'stepper'", "there are: epos2-can, epos2-serial"),
    ),
    Mistake(
        "unknown device",
        ('device = "70/10"', 'device = "70/11"'),
        "axes[0].settings.device",
        ("'70/11'", "perhaps '70/10'?"),
    ),
    Mistake(
        "unknown role",
        ('role = "steering"', 'role = "stering"'),
        "axes[2].role",
        ("'stering' is no role of this kind", "perhaps 'steering'?"),
    ),
    Mistake(
        "a role twice",
        ('role = "right_wheel"', 'role = "left_wheel"'),
        "axes[1].role",
        ("'left_wheel' is taken by axes[0]", "'right_wheel' is free"),
    ),
    Mistake(
        "duplicate name", ('name = "right"', 'name = "left"'), "axes[1].name", ("'left' is taken by axes[0]",)
    ),
    Mistake(
        "duplicate node",
        ("node = 2\n", "node = 1\n"),
        "axes[1].settings.node",
        ("1 is the node of axes[0]",),
    ),
    Mistake(
        "the bridge's own node",
        ("node = 2\n", "node = 100\n"),
        "axes[1].settings.node",
        ("the bridge's own node", "links.drives.bridge_node"),
    ),
    Mistake(
        "an axis on an unknown link",
        ('link = "drives"\ncommand', 'link = "drive"\ncommand'),
        "axes[0].link",
        ("no link 'drive'", "perhaps 'drives'?"),
    ),
    Mistake(
        "a link without devices",
        (LINK, LINK + LINK.replace("drives", "far", 1)),
        "links.far",
        ("no axis and no sensor",),
    ),
    Mistake(
        "a table in the place of named links",
        (LINK, "links = 3\n"),
        "links",
        ("must be a table", "3"),
    ),
    Mistake(
        "a bit rate that no drive has",
        ("bit_rate = 1_000_000", "bit_rate = 83_333"),
        "links.drives.bit_rate",
        ("must be one of 1000000, 800000", "83333"),
    ),
    Mistake(
        "unknown sensor of the battery",
        ('sensor = "battery"', 'sensor = "batery"'),
        "battery.sensor",
        ("no sensor 'batery'", "perhaps 'battery'?"),
    ),
    Mistake(
        "a battery low from the start", ("low_v = 21.0", "low_v = 31.0"), "battery", ("low_v must be below",)
    ),
    Mistake(
        "unknown axis of a sensor",
        ('axis = "left", input', 'axis = "lefd", input'),
        "sensors[0].settings.axis",
        ("no axis 'lefd'", "perhaps 'left'?"),
    ),
    Mistake(
        "two outputs at one pin",
        ("[plant]", OUTPUT.format(name="lamp") + OUTPUT.format(name="horn") + "[plant]"),
        "outputs[1].settings.output",
        ("1 is that of outputs[0]",),
    ),
    Mistake(
        "a position axis without travel",
        ("travel = [-2.66647, 2.66647]", ""),
        "axes[2]",
        ("needs travel = [lowest, highest]",),
    ),
    Mistake(
        "a travel that falls",
        ("travel = [-2.66647, 2.66647]", "travel = [2.66647, -2.66647]"),
        "axes[2].travel",
        ("must rise",),
    ),
    Mistake(
        "a travel with one end",
        ("travel = [-2.66647, 2.66647]", "travel = [2.66647]"),
        "axes[2].travel[1]",
        ("is missing",),
    ),
    Mistake("no direction", ("direction = 1", "direction = 0"), "axes[0].direction", ("must be 1 or -1",)),
    Mistake(
        "a top speed below what the limits ask",
        ("top_speed = 16.0 ", "top_speed = 1.0 "),
        "axes[0].top_speed",
        ("'left' be asked for 14.8", "the bound is 1 rad/s", "narrow the limits"),
    ),
    Mistake(
        "silence within a cycle",
        ("drive_heartbeat_ms = 100\nsilent_ms = 250", "drive_heartbeat_ms = 30\nsilent_ms = 50"),
        "links.drives.silent_ms",
        ("50 is not longer than the link's cycle, 50",),
    ),
    Mistake(
        "a stop that no sample can confirm in time",
        ("silent_ms = 250 ", "stop_confirmed_ms = { quick_stop = 100 }\nsilent_ms = 250 "),
        "links.drives.stop_confirmed_ms.quick_stop",
        ("100 is not longer than two of the link's cycles, 100",),
    ),
    Mistake(
        "a step of a stop that there is not",
        ("silent_ms = 250 ", "stop_confirmed_ms = { quick = 200 }\nsilent_ms = 250 "),
        "links.drives.stop_confirmed_ms.quick",
        ("no such key", "quick_stop"),
    ),
    Mistake(
        "a gateway that is no node",
        ('driver = "epos2-can"', 'driver = "epos2-serial"\ngateway = 9'),
        "links.drives.gateway",
        ("9 is not the node of an axis",),
    ),
    Mistake(
        "a serial link without a gateway",
        ('driver = "epos2-can"', 'driver = "epos2-serial"'),
        "links.drives",
        ("needs gateway",),
    ),
    Mistake(
        "a link that stops an unknown group",
        ("silent_ms = 250 ", 'stops = ["bass"]\nsilent_ms = 250 '),
        "links.drives.stops",
        ("no group 'bass'", "perhaps 'base'?"),
    ),
    Mistake(
        "a link that leaves the group of its own axis going",
        ("silent_ms = 250 ", 'stops = ["base"]\nsilent_ms = 250 '),
        "links.drives.stops",
        ("leaves out the group 'lift'", "'lift' is on this link"),
    ),
    Mistake(
        "a sum with an unknown axis",
        ("of = { left = 0.025,", "of = { lefft = 0.025,"),
        "guard.sums[0].of.lefft",
        ("no such axis", "perhaps 'left'?"),
    ),
    Mistake(
        "a sum of nothing",
        ("of = { left = 0.025, right = 0.025 }", "of = {}"),
        "guard.sums[0].of",
        ("at least 1",),
    ),
    Mistake(
        "a sum with a position",
        ("of = { left = 0.025,", "of = { steer = 0.025,"),
        "guard.sums[0].of.steer",
        ("is commanded by position",),
    ),
    Mistake(
        "one axis on both sides",
        ('other = ["lift"]', 'other = ["lift", "left"]'),
        "guard.exclusive[0].other",
        ("'left'", "exclude itself"),
    ),
    Mistake(
        "a plant that is not installed",
        ('fmu = "rars"', 'fmu = "rasr"'),
        "plant.fmu",
        ("no plant 'rasr' is installed", "perhaps 'rars'?"),
    ),
    Mistake(
        "unknown parameter set",
        ('parameter_set = "A"', 'parameter_set = "A_plausible_jaw"'),
        "plant.parameter_set",
        ("no parameter set", "perhaps 'A_plausible_yaw'?"),
    ),
    Mistake(
        "unknown parameter of the plant",
        ('parameter_set = "A"', "parameters = { gravyti = 1.6 }"),
        "plant.parameters.gravyti",
        ("no parameter 'gravyti'",),
    ),
    Mistake(
        "unknown kind by name", ('name = "rars"', 'name = "rarss"'), "name", ("'rarss'", "perhaps 'rars'?")
    ),
    Mistake(
        "unknown kind",
        ('name = "rars"', 'name = "mine"\nkind = "rasr"'),
        "kind",
        ("no kind of robot 'rasr'", "perhaps 'rars'?"),
    ),
    Mistake("a kind that is no name", ('name = "rars"', "name = [1]"), "name", ("no kind of robot '[1]'",)),
    Mistake(
        "a node that is no number", ("node = 2\n", "node = [2]\n"), "axes[1].settings.node", ("an integer",)
    ),
    Mistake("a name that is no name", ('name = "right"', "name = []"), "axes[1].name", ("must be a string",)),
    Mistake(
        "a number beyond all bounds",
        ("turn_radius_m = 0.415", "turn_radius_m = nan"),
        "geometry.limits.turn_radius_m",
        ("finite",),
    ),
)
THREE_AT_ONCE = (
    ("unknown key", "unknown device", "a sum with an unknown axis"),
    ("wrong type", "unknown role", "a plant that is not installed"),
    ("missing table", "duplicate node", "unknown parameter set"),
    ("a driver that does not serve", "unknown sensor of the battery", "a travel that falls"),
    ("an axis on an unknown link", "a link without devices", "unknown key of an axis"),
)
BY_TITLE = {mistake.title: mistake for mistake in MISTAKES}


def robots(*words: str) -> Result:
    return CliRunner().invoke(program, ["robots", *words])


def told_of(file: Path) -> list[str]:
    """Check a file, which must be refused; return what is said of it, a line each."""
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


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.title)
def test_a_mistake_is_told_in_one_line_with_file_key_and_what_to_do(mistake: Mistake, tmp_path: Path) -> None:
    (line,) = told_of(written(tmp_path, mistake.made_in(RARS)))
    assert line.startswith(f"{mistake.key}: ")
    assert [word for word in mistake.words if word not in line] == []


@pytest.mark.parametrize("titles", THREE_AT_ONCE, ids=" & ".join)
def test_three_mistakes_are_told_at_once(titles: tuple[str, ...], tmp_path: Path) -> None:
    text = RARS
    for title in titles:
        text = BY_TITLE[title].made_in(text)
    lines = told_of(written(tmp_path, text))
    assert len(lines) == len(titles)
    for title in titles:
        mistake = BY_TITLE[title]
        assert any(
            line.startswith(f"{mistake.key}: ") and all(word in line for word in mistake.words)
            for line in lines
        ), title


def test_a_robot_without_a_lift_is_no_rars(tmp_path: Path) -> None:
    """It once passed as good, and died of a KeyError."""
    lines = told_of(written(tmp_path, RARS.replace(LIFT, "").replace(EXCLUSIVE, "")))
    assert lines == ["axes: no axis has the role 'lift', which the group 'lift' needs"]


def test_every_role_that_has_no_axis_is_told(tmp_path: Path) -> None:
    one = RARS[: RARS.index('[[axes]]\nname = "right"')].replace(EXCLUSIVE, "")
    lines = told_of(written(tmp_path, one[: one.index("[[guard.sums]]")] + one[one.index("[plant]") :]))
    assert [line.split("'")[1] for line in lines] == ["right_wheel", "steering", "lift"]


@pytest.mark.parametrize(
    ("content", "told"),
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
def test_a_file_that_is_no_robot_is_refused(content: bytes, told: str, tmp_path: Path) -> None:
    file = tmp_path / "robot.toml"
    file.write_bytes(content)
    (line,) = told_of(file)
    assert line.startswith(told)


def test_a_folder_and_a_file_that_is_not_there_are_refused(tmp_path: Path) -> None:
    assert told_of(tmp_path) == ["cannot be read: Is a directory"]
    assert told_of(tmp_path / "nowhere.toml") == ["cannot be read: No such file or directory"]


def test_all_wrong_files_are_told_in_one_run(tmp_path: Path) -> None:
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
