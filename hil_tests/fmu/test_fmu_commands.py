"""`fmu list`, `fmu build` and `fmu check`, as a user meets them."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest
from fmpy.model_description import read_model_description
from typer.testing import CliRunner

from emulators.arduino_omni.ar2.plant_joints import ANGLES, INPUTS
from emulators.bench.bench_setup import bench_setup_of
from emulators.robot_plant import plant_parameters
from firmware_bridge import robot_types
from firmware_bridge.cli import program
from firmware_bridge.families.ar2.settings import Ar2Link
from fmu.build import ensure
from fmu.errors import PlantError, UnknownNameError
from fmu.plants import find, names
from fmu.platforms import Platform, elsewhere, find_compiler, here
from fmu.sources import token_of
from fmu.summary import summary


def run(*words: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(program, ["fmu", *words], env={"COLUMNS": "200", "NO_COLOR": "1"})
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.stdout, result.stderr


def changed(original: Path, target: Path, old: str, new: str) -> str:
    with ZipFile(original) as source, ZipFile(target, "w", ZIP_DEFLATED) as archive:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                assert old.encode() in content
                content = content.replace(old.encode(), new.encode())
            archive.writestr(name, content)
    return str(target)


def test_list_names_every_model_and_its_robot() -> None:
    status, out, err = run("list")
    assert (status, err) == (0, "")
    for model in names():
        (row,) = [line for line in out.splitlines() if line.startswith(f"│ {model} ")]
        assert model != "rars" or [cell.strip() for cell in row.split("│")][3:7] == ["34", "4", "23", "79"]


@pytest.mark.parametrize(
    ("model", "rows", "reported"),
    [
        (
            "single_axis",
            ("backlash rad 0.02 backlash", "gear_axis 1 26 gear ratio"),
            "voltage_axis",
        ),
        ("rome", ("wheel_distance m 0.16 ", "gear_wheel 1 64 "), "parameter sets: kit, "),
    ],
)
def test_show_lists_what_can_be_set(model: str, rows: tuple[str, ...], reported: str) -> None:
    status, out, err = run("show", model)
    assert (status, err) == (0, "")
    cells = [" ".join(line.replace("│", " ").split()) for line in out.splitlines()]
    for row in rows:
        assert any(line.startswith(row.strip()) for line in cells), row
    assert reported in out


def test_show_lists_what_an_fmu_of_anybody_has(tmp_path: Path) -> None:
    status, out, err = run("show", str(ensure("single_axis")))
    assert (status, err) == (0, "")
    assert "backlash" in out
    assert "outputs: current_axis, angle_axis, speed_axis" in out
    status, _, err = run("show", str(tmp_path / "none.fmu"))
    assert status == 2
    assert "there is no such file" in err


def test_a_drive_takes_a_plant_by_its_name_and_names_a_parameter_that_is_none() -> None:
    words = ["emulate", "epos2", "--serial", "pty", "--duration", "0.1", "--plant"]
    done = CliRunner().invoke(program, [*words, "single_axis", "--set", "stop_lo=-1"])
    assert done.exit_code == 2, done.output
    assert "the nearest name is 'stop_low'; `firmware-bridge fmu show` lists what it has" in done.stderr
    done = CliRunner().invoke(program, [*words, "single_axis", "--set", "stop_low=-1"])
    assert done.exit_code == 0, done.output
    assert "the plant single_axis" in done.stdout
    done = CliRunner().invoke(program, [*words, "single_axs"])
    assert done.exit_code == 2
    assert "did you mean 'single_axis'?" in done.stderr


def test_a_plant_that_is_not_built_is_summed_up_by_its_equations(monkeypatch: pytest.MonkeyPatch) -> None:
    built = summary("single_axis")
    monkeypatch.setattr("fmu.summary.is_built", lambda _: False)
    assert summary("single_axis") == built


@pytest.mark.long(keeps=["3"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_build_writes_what_check_finds_good(tmp_path: Path, fmi: int) -> None:
    path = tmp_path / "new" / "plant.fmu"
    status, out, err = run("build", "rars", "--fmi", str(fmi), "--out", str(path))
    assert (status, err) == (0, "")
    assert out.startswith(f"{path}: rars as rars has it, FMI {fmi}.0, co-simulation and model exchange, ")
    assert read_model_description(str(path)).fmiVersion == f"{fmi}.0"
    status, out, err = run("check", str(path))
    assert (status, err) == (0, "")
    others = "ar2 lacks 24, climber lacks 4, rome lacks 13, rome_arm lacks 38, servo_axis lacks 6"
    assert out.splitlines() == [
        "verdict:      good; it fits diff_drive, rars",
        f"model:        rars, 183 variables, FMI {fmi}.0, co-simulation and model exchange",
        "checked:      description: valid; start: loads, initializes, takes a step",
        "bits:         those that its equations give, in a run of its own",
        f"other robots: {others}; --robot NAME lists it",
    ]


QUICK = """
import sys
from firmware_bridge.cli import main
sys.argv[0] = "firmware-bridge"
try:
    main()
finally:
    print(*({"sympy", "numpy", "fmpy", "matplotlib", "emulators.rig"} & sys.modules.keys()), "loaded")
"""


def test_a_plant_that_was_built_before_is_written_at_once(tmp_path: Path) -> None:
    """No equations, no compiler, none of the libraries that take a second to import."""
    path = tmp_path / "plant.fmu"
    words = [sys.executable, "-c", QUICK, "fmu", "build", "single_axis", "--out", str(path)]
    first = subprocess.run(words, capture_output=True, text=True, check=True)
    again = subprocess.run(words, capture_output=True, text=True, check=True)
    assert again.stdout.splitlines()[:2] == first.stdout.splitlines()[:2]
    assert again.stdout.splitlines()[-1] == "loaded"


def test_a_compiler_that_is_missing_is_named_and_its_binary_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ensure("single_axis")
    monkeypatch.setenv("CC", find_compiler())
    monkeypatch.setenv("PATH", str(tmp_path))
    status, out, err = run("build", "single_axis", "--out", str(tmp_path / "plant.fmu"))
    assert (status, err) == (0, "")
    _, held, *missing = out.splitlines()
    assert held == f"binaries: {here().name}"
    assert missing == [
        f"no binary for {one.name}: no {one.compiler} here (Debian's {one.package}); its sources build there"
        for one in elsewhere()
    ]
    with ZipFile(tmp_path / "plant.fmu") as archive:
        binaries = [name for name in archive.namelist() if name.startswith("binaries/")]
    assert binaries == [here().binary("single_axis", 3)]


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_compiler_for_another_machine_adds_its_binary(fmi: int) -> None:
    """Another machine that is this one, so that its binary can be looked at here."""
    other = Platform("z80-linux", "z80", ".so", find_compiler(), "gcc-z80", ("-DOTHER",))
    own, both = ensure("single_axis", fmi), ensure("single_axis", fmi, [other])
    with ZipFile(own) as alone, ZipFile(both) as archive:
        added = set(archive.namelist()) - set(alone.namelist())
        assert added == {other.binary("single_axis", fmi)}
        assert added == {f"binaries/{'z80' if fmi == 2 else 'z80-linux'}/single_axis.so"}
        assert archive.read(other.binary("single_axis", fmi)) == alone.read(here().binary("single_axis", fmi))
    with pytest.raises(PlantError, match="no z80-gcc for z80-linux: install Debian's gcc-z80"):
        ensure("single_axis", fmi, [replace(other, compiler="z80-gcc")])
    broken = replace(other, flags=("-include", "no-such-file.h"))
    with pytest.raises(PlantError, match="failed"):
        ensure("single_axis", fmi, [broken])


def test_build_goes_into_this_folder_unless_reported_otherwise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("build", "rars")[0] == 0
    assert [path.name for path in tmp_path.iterdir()] == ["rars.fmu"]


@pytest.mark.parametrize(
    ("words", "logged"),
    [
        (
            ("build", "mars"),
            "there is no plant 'mars'; did you mean 'rars'? there are: ar2, castors, climber, ",
        ),
        (
            ("build", "rars", "--out", "/proc/nowhere/rars.fmu"),
            "/proc/nowhere/rars.fmu: the FMU cannot be written",
        ),
        (("check", "nowhere.fmu"), "nowhere.fmu: there is no such file"),
        (("check", __file__), "not an FMU"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_status_2(words: tuple[str, ...], logged: str) -> None:
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    (line,) = err.splitlines()
    assert logged in line


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    status, _, err = run("build", "rars", "--out", str(tmp_path))
    assert status == 2
    assert len(err.splitlines()) == 1
    assert list(tmp_path.parent.glob(".*.part")) == []


@pytest.mark.long(keeps=['name="current_left"-name="strom"-the FMU lacks the output \'current_left\''])
@pytest.mark.parametrize(
    ("old", "new", "logged"),
    [
        ('name="current_left"', 'name="strom"', "the FMU lacks the output 'current_left'"),
        ('unit="rad/s"', 'unit="m/s"', "'speed_left' is in 'm/s', but 'rad/s' was expected"),
        ('instantiationToken="{', 'instantiationToken="{0', "the token is not that of modelDescription.xml"),
        ('unit="V"', 'unit="Volt"', 'The unit "Volt"'),
    ],
)
def test_problems_are_named_and_make_status_1(
    fmu_file: dict[int, Path], tmp_path: Path, old: str, new: str, logged: str
) -> None:
    path = changed(fmu_file[3], tmp_path / "odd.fmu", old, new)
    status, out, err = run("check", path, "--robot", "rars")
    assert status == 1
    problems = err.splitlines()
    assert out.startswith(f"verdict:      {len(problems)} problem")
    assert all(line.startswith("problem: ") for line in problems)
    assert [line for line in problems if logged in line], problems


def requested_of_a_plant(name: str) -> list[str]:
    """Return the bench's needs of an installed robot's plant: axes, supply, and columns to draw."""
    robot = robot_types.find(name)
    motors = [axis.name for axis in robot.axes if axis.link not in Ar2Link.all_of(robot)]
    axes = [f"{quantity}_{axis}" for quantity in ("voltage", "current", "angle", "speed") for axis in motors]
    supply = ("battery_voltage",) if motors else ()
    joints = (*INPUTS, *ANGLES) if Ar2Link.all_of(robot) else ()
    drawn = (column.plant for column in bench_setup_of(robot).columns if column.plant)
    return list(dict.fromkeys((*axes, *supply, *joints, *drawn)))


@pytest.mark.parametrize(
    ("robot", "axes", "body"),
    [
        ("diff_drive", ["left", "right"], ["x", "y", "heading", "speed", "yaw_rate"]),
        (
            "rars",
            ["left", "right", "steer", "lift"],
            ["x", "y", "heading", "speed", "yaw_rate", "steer", "lift_height"],
        ),
    ],
)
def test_a_robot_requests_its_axes_and_its_body(robot: str, axes: list[str], body: list[str]) -> None:
    requested = requested_of_a_plant(robot)
    assert requested[: len(axes)] == [f"voltage_{axis}" for axis in axes]
    assert requested[4 * len(axes) :] == ["battery_voltage", *body]


def test_all_that_is_missing_is_named(pendulums: Callable[[int], Path]) -> None:
    """A plant of anybody's is good in itself, whichever robot it is not made for."""
    status, out, err = run("check", str(pendulums(2)))
    assert (status, err) == (0, "")
    assert out.startswith("verdict:      good; it fits the bench of no installed robot\n")
    others = out.splitlines()[4].split(": ", 1)[1].split(", ")
    assert [entry.split()[0] for entry in others] == sorted(robot_types.names())
    for name in robot_types.names():
        status, _, err = run("check", str(pendulums(2)), "--robot", name)
        assert status == 1
        lacking = [line.split("'")[1] for line in err.splitlines() if "the FMU lacks" in line]
        requested = [word for word in requested_of_a_plant(name) if word not in {"speed", "height"}]
        assert sorted(lacking) == sorted(requested), name
    _, _, err = run("check", str(pendulums(2)), "--robot", "climber")
    assert "'speed' is in 'rad/s', but 'm/s' was expected" in err


@pytest.mark.long(keeps=["3"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_model_exchange_alone_is_not_enough_for_the_bench(
    fmu_file: dict[int, Path], tmp_path: Path, fmi: int
) -> None:
    path = tmp_path / "model.fmu"
    with ZipFile(fmu_file[fmi]) as source, ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                text = content.decode()
                lines = [line for line in text.splitlines() if "<CoSimulation" not in line]
                if fmi == 2:
                    begin, end = lines.index("  </ModelExchange>"), lines.index("  </CoSimulation>")
                    del lines[begin + 1 : end + 1]
                content = "\n".join(lines).encode()
            archive.writestr(name, content)
    status, out, err = run("check", str(path), "--robot", "rars")
    assert status == 1
    assert f", FMI {fmi}.0, model exchange\n" in out
    assert "no co-simulation; export it with its solver" in err


@pytest.mark.parametrize("command", ["list", "build", "check"])
def test_each_command_explains_itself_with_an_example(command: str) -> None:
    status, out, _ = run(command, "--help")
    assert status == 0
    assert f"firmware-bridge fmu {command}" in out


@pytest.mark.long(keeps=["rome"])
@pytest.mark.parametrize("name", robot_types.names())
def test_a_robot_s_plant_begins_with_what_its_file_states(tmp_path: Path, name: str) -> None:
    path = tmp_path / "plant.fmu"
    assert run("build", name, "--out", str(path))[0] == 0
    given = {
        variable.name: float(variable.start)
        for variable in read_model_description(str(path)).modelVariables
        if variable.causality == "parameter"
    }
    wanted = plant_parameters(robot_types.find(name))
    assert wanted
    assert {key: given[key] for key in wanted} == wanted


def test_a_plant_s_own_start_values_are_those_of_its_equations() -> None:
    climber = find("climber")
    other = climber.starting({"gear_wheel": 30.0})
    assert {row.name: row.start for row in other.model().parameters}["gear_wheel"] == 30.0
    assert token_of(other) != token_of(climber)
    same = {row.name: row.start for row in climber.parameters}
    assert climber.starting(same) is climber, "it comes with the package, and needs no compiler"
    with pytest.raises(UnknownNameError, match="the plant 'climber' has no parameter"):
        climber.starting({"wings": 2.0})
