"""`new`: from nothing to a driven robot in three commands; what it writes, and what it refuses."""

import ast
import json
import math
import os
import resource
import tomllib
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import pytest
from diff_drive.plant import PLANT
from typer.testing import CliRunner

from emulators.epos2.starter.numbers import Specification
from emulators.epos2.starter.package import written
from emulators.epos2.starter.tuning import velocity_gains
from emulators.motors import MOTORS
from firmware_bridge.cli import program
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Device
from firmware_bridge.robot.model import Unpowered
from firmware_bridge.robot_types import find
from hil_tests.robots.beside import PRODUCT, ROOT, Beside, files

PROCESSOR_S: Final = 60.0
DIFF_DRIVE: Final = Specification(
    kind="differential",
    name="diff_drive",
    nodes=(1, 2),
    wheel_radius_m=0.08,
    track_m=0.35,
    motor=MOTORS["RE40"],
)
MOUSE: Final = (
    *("new", "mouse", "--kind", "differential", "--nodes", "5,6", "--axes", "port,starboard"),
    *("--wheel-radius", "0.05", "--track", "0.25", "--mass", "8", "--motor", "RE25", "--gear", "20"),
)


@pytest.fixture(scope="module")
def mouse(tmp_path_factory: pytest.TempPathFactory) -> tuple[Beside, float]:
    """Write and install a robot, and drive it; return where it is, and the processor time of all of it."""
    beside = Beside(tmp_path_factory.mktemp("beside"))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    beside.bridge(*MOUSE)
    beside.installs("./mouse")
    beside.bridge("bench", "mouse", "--mission", "line", "--out", "driven")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return beside, used


def test_three_commands_drive_a_robot_and_touch_nothing_of_the_product(
    request: pytest.FixtureRequest,
) -> None:
    before = files()
    beside, used = request.getfixturevalue("mouse")
    assert files() == before
    assert used < PROCESSOR_S
    assert (beside.folder / "driven" / "summary.json").is_file()
    assert "mouse" in beside.bridge("robots")


@pytest.mark.long(beside="test_three_commands_drive_a_robot_and_touch_nothing_of_the_product")
def test_without_a_mission_it_drives_its_figure_of_eight(mouse: tuple[Beside, float]) -> None:
    beside, _ = mouse
    beside.bridge("bench", "mouse", "--out", "eight")
    summary = json.loads((beside.folder / "eight" / "summary.json").read_text(encoding="utf-8"))
    assert summary["mission"] == "figure_eight"


@pytest.mark.long(beside="test_three_commands_drive_a_robot_and_touch_nothing_of_the_product")
@pytest.mark.parametrize("chosen", ["mouse and interlock", "mouse and not figure_eight and not interlocks"])
def test_it_gets_the_safety_tests_of_every_robot(mouse: tuple[Beside, float], chosen: str) -> None:
    """From what is installed, beside no checkout."""
    beside, _ = mouse
    pytest_words = ("-m", "pytest", "-q", "-p", "no:xdist", "-p", "no:cacheprovider")
    inherited = ("--robot", "mouse", "--pyargs", "emulators.testing.inherited")
    assert " passed" in beside.run(*pytest_words, *inherited, "-k", chosen)


@pytest.mark.long(beside="test_three_commands_drive_a_robot_and_touch_nothing_of_the_product")
def test_what_it_writes_is_code_to_hold_up(mouse: tuple[Beside, float]) -> None:
    beside, _ = mouse
    beside.run("-m", "ruff", "check", "--no-cache", "mouse")
    beside.run("-m", "ruff", "format", "--no-cache", "--check", "mouse")
    words = ("--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(ROOT / ".mypy_cache"))
    beside.run(
        "-m", "mypy", *words, "-p", "mouse", MYPYPATH=f"{beside.folder / 'mouse' / 'src'}{os.pathsep}{ROOT}"
    )


def test_the_example_is_what_it_writes_and_what_was_added_to_it() -> None:
    example = ROOT / "examples/diff_drive"
    for name, text in written(DIFF_DRIVE).items():
        found = (example / name).read_text(encoding="utf-8")
        if name == "src/diff_drive/diff_drive.toml":
            assert found.startswith(text)
            assert list(tomllib.loads(found.removeprefix(text))) == ["outputs"]
        else:
            assert found == text, name


def test_the_rule_for_gains_gives_those_that_rars_was_tuned_to() -> None:
    """RARS's wheels: 70 kg on two RE50 behind 26:1; tuned on the plant before there was a rule."""
    tuned = Epos2Axis.of(find("rars").axis("left_wheel")).gains
    inertia = 536e-7 + (35.0 * 0.05**2 + 465e-6) / 26.0**2
    gains = velocity_gains(MOTORS["RE50"], inertia, 24.0)
    assert (gains.current_p, gains.current_i) == (tuned.current_p, tuned.current_i)
    assert gains.velocity_p == pytest.approx(tuned.velocity_p, rel=0.05)
    assert gains.velocity_i == pytest.approx(tuned.velocity_i, rel=0.10)
    assert gains.velocity_feedforward == pytest.approx(tuned.velocity_feedforward, rel=0.01)
    assert gains.acceleration_feedforward == pytest.approx(tuned.acceleration_feedforward, rel=0.10)


def test_the_friction_that_it_writes_is_more_than_its_plant_has_and_less_than_a_slope() -> None:
    """Check the current that holds the robot on 3 degrees: it must not pass for friction."""
    axis, motor = find("diff_drive").axis("left_wheel"), MOTORS["RE40"]
    plant = {parameter.name: parameter.start for parameter in PLANT.parameters}
    half = DIFF_DRIVE.mass_kg * 9.81 / 2.0
    a_newton = DIFF_DRIVE.wheel_radius_m / axis.ratio / motor.torque_constant_nm_a
    rolls = half * max(plant["rolling_resistance"], plant["castor_resistance"]) * a_newton
    slope = half * math.sin(math.radians(3.0)) * a_newton
    assert motor.no_load_current_a + rolls < axis.friction < slope
    assert axis.standstill_group == "base"
    assert axis.unpowered is Unpowered.FREE


@pytest.mark.parametrize(
    ("words", "stated"),
    [
        (("Mouse",), "NAME: 'Mouse' is no name"),
        (("class",), "NAME: 'class' is no name"),
        (("json",), "there is a Python package 'json' already"),
        (("rars",), "the robot 'rars' is installed already"),
        (("single_axis",), "the plant 'single_axis' is installed already"),
        (("mickey", "--kind", "diferential"), "--kind: no kind 'diferential'; perhaps 'differential'?"),
        (("mickey", "--device", "70/11"), "--device: no EPOS2 '70/11'; perhaps '70/10'?"),
        (("mickey", "--motor", "RE41"), "--motor: no motor 'RE41' is known; perhaps 'RE40'?"),
        (("mickey", "--motor", "no.toml"), "no.toml: cannot be read"),
        (("mickey", "--nodes", "1,1"), "--nodes: '1' stands twice"),
        (("mickey", "--nodes", "1"), "--nodes: two with a comma between"),
        (("mickey", "--nodes", "0,1"), "a number from 1 to 127, not '0'"),
        (("mickey", "--nodes", "1,128"), "a number from 1 to 127, not '128'"),
        (("mickey", "--axes", "left,Right"), "--axes: 'Right' is no name"),
        (("mickey", "--wheel-radius", "0"), "--wheel-radius must be positive, not 0"),
        (("mickey", "--track", "-1"), "--track must be positive, not -1"),
        (("mickey", "--mass", "nan"), "--mass must be positive, not nan"),
        (("mickey", "--speed", "inf"), "--speed must be positive, not inf"),
        (("mickey", "--gear", "0"), "--gear must be positive, not 0"),
        (("mickey", "--voltage", "-24"), "--voltage must be positive, not -24"),
        (("mickey", "--acceleration", "0"), "--acceleration must be positive, not 0"),
        (("mickey", "--turn-rate", "inf"), "--turn-rate must be positive, not inf"),
        (
            ("mickey", "--wheel-radius", "0.35"),
            "--wheel-radius 0.35 is not below --track 0.35: both are in me",
        ),
        (
            ("mickey", "--gear", "0.0233"),
            "--gear 0.0233: at the speed limit the motor turns with 2.3 rpm, it can",
        ),
        (
            ("mickey", "--motor", "nonsense"),
            "there are RE25, RE40, RE50, and 171 by order number or a part of",
        ),
        (("mickey", "--encoder-lines", "100000"), "--encoder-lines: 100000 lines at 4"),
        (("mickey", "--voltage", "70.5"), "--voltage 70.5: an EPOS2 70/10 takes 70 V at most: take another"),
        (("mickey", "--gear", "200"), "take a smaller --gear, or less --speed"),
        (("mickey", "--encoder-lines", "1"), "--encoder-lines must be 16 to"),
        (("mickey", "--travel", "0,1"), "--travel: a robot of the kind differential takes no such option"),
        (("mickey", "--dir", "."), "is there already; take another --dir"),
    ],
)
def test_what_makes_no_robot_is_refused_in_one_line_and_nothing_is_written(
    words: tuple[str, ...], stated: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    sizes = ["--wheel-radius", "0.08", "--track", "0.35"]
    result = CliRunner().invoke(program, ["new", *sizes, *words])
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert line.startswith("firmware-bridge: ")
    assert stated in line
    assert list(tmp_path.iterdir()) == []


def test_a_motor_of_ones_own_comes_from_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    data = "\n".join(
        f"{key} = {value!r}".replace("'", '"')
        for key, value in MOTORS["RE25"].model_dump(exclude_none=True).items()
    )
    Path("mine.toml").write_text(data.replace("maxon RE25", "my RE25"), encoding="utf-8")
    words = ["--wheel-radius", "0.05", "--track", "0.25", "--mass", "8", "--gear", "20"]
    result = CliRunner().invoke(program, ["new", "mickey", *words, "--motor", "mine.toml"])
    assert result.exit_code == 0, result.output
    assert 'motor = "my RE25 20 W 24 V"' in Path("mickey/src/mickey/mickey.toml").read_text(encoding="utf-8")
    Path("mine.toml").write_text(data.replace("resistance_ohm", "resistanc_ohm"), encoding="utf-8")
    wrong = CliRunner().invoke(program, ["new", "other", *words, "--motor", "mine.toml"])
    assert wrong.exit_code == 2
    assert "mine.toml: resistance_ohm: is missing" in wrong.stderr


def imported(path: Path) -> set[str]:
    """Return the product's modules that a file imports."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            module = node.module or ""
            inner = [f"{module}.{name.name}" for name in node.names]
            found.update(
                name if (ROOT / f"{name.replace('.', '/')}.py").is_file() else module for name in inner
            )
    return {name for name in found if name.split(".")[0] in PRODUCT}


def test_the_examples_import_public_modules_alone() -> None:
    pages = [
        (ROOT / "docs" / name).read_text(encoding="utf-8") for name in ("your-robot.md", "device-family.md")
    ]
    listed = "\n".join(page.partition("## Public modules")[2] for page in pages)
    public = {line.split("`")[1] for line in listed.splitlines() if line.startswith("| `")}
    used = {module for path in (ROOT / "examples").rglob("*.py") for module in imported(path)}
    assert used
    assert used <= public
    assert [module for module in public if find_spec(module) is None] == []


@pytest.mark.parametrize("device", Epos2Device)
def test_no_motor_is_given_more_than_its_drive_has_and_that_is_stated(
    device: Epos2Device, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An RE40 may have 5.77 A for as long as it likes."""
    monkeypatch.chdir(tmp_path)
    words = ["new", "mouse", "--wheel-radius", "0.08", "--track", "0.35", "--device", device.value]
    reported = CliRunner().invoke(program, words)
    assert reported.exit_code == 0, reported.output
    axes = tomllib.loads((tmp_path / "mouse" / "src" / "mouse" / "mouse.toml").read_text(encoding="utf-8"))[
        "axes"
    ]
    settings = [axis["settings"] for axis in axes]
    currents = {(one["continuous_current_ma"], one["peak_current_ma"]) for one in settings}
    continuous = min(5770, device.continuous_ma)
    assert currents == {(continuous, min(2 * continuous, device.peak_ma))}
    assert ("are more than an EPOS2" in reported.output) is (device.continuous_ma < 5770)


@pytest.mark.parametrize(
    ("order", "pole_pairs", "reported"),
    [
        ("397172", 8, ""),
        (
            "651607",
            None,
            "no source states the pole pairs of EC 45 flat 50W 24V (2025) (651607): set 0x6410:3",
        ),
    ],
)
def test_an_ec_motor_is_commutated_as_one(
    order: str, pole_pairs: int | None, reported: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["new", "mouse", "--wheel-radius", "0.08", "--track", "0.35", "--motor", order]
    written = CliRunner().invoke(program, words)
    assert written.exit_code == 0, written.output
    file = tmp_path / "mouse/src/mouse/mouse.toml"
    axes = tomllib.loads(file.read_text(encoding="utf-8"))["axes"]
    found = {(axis["settings"]["motor_type"], axis["settings"].get("pole_pairs")) for axis in axes}
    assert found == {(10, pole_pairs)}
    assert reported in written.output
