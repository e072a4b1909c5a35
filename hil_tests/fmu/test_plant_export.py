"""The FMU as a file: valid, described, reproducible, with the sources that rebuild the same bits."""

import ctypes
import hashlib
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu

from firmware_bridge.robot_types import find
from fmu import build, ready
from fmu.errors import PlantError
from fmu.plant import FmuPlant
from fmu.platforms import find_compiler
from fmu.rars.interface import INPUTS, OUTPUTS
from fmu.rars.parameters import PARAMETERS, PLANT, ROBOT_FILE, SETS
from validation.references import rars as reference


def run(command: list[str], **options: Any) -> None:
    subprocess.run(command, check=True, **options)


COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]


@pytest.mark.long(beside="test_fmpy_finds_nothing_wrong")
@pytest.mark.parametrize("fmi", [2, 3])
def test_fmpys_checker_finds_nothing(fmu_file: dict[int, Path], fmi: int) -> None:
    assert validate_fmu(str(fmu_file[fmi])) == []


@pytest.mark.parametrize("fmi", [2, 3])
def test_description_carries_units_and_nominal_values(fmu_file: dict[int, Path], fmi: int) -> None:
    description = read_model_description(str(fmu_file[fmi]))
    assert description.coSimulation.canBeInstantiatedOnlyOncePerProcess is False
    assert description.coSimulation.canGetAndSetFMUstate
    variables = {variable.name: variable for variable in description.modelVariables}
    for name, unit in INPUTS.items():
        assert (variables[name].causality, variables[name].unit) == ("input", unit)
    for name, unit in OUTPUTS.items():
        assert (variables[name].causality, variables[name].unit) == ("output", unit)
        assert float(variables[name].nominal) > 0
    for row in PARAMETERS:
        variable = variables[row.name]
        assert (variable.causality, variable.unit, float(variable.start)) == (
            "parameter",
            row.unit,
            row.start,
        )
        assert row.source in variable.description


@pytest.mark.long(keeps=["3-single_axis"])
@pytest.mark.parametrize("plant", ["rars", "single_axis"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_building_twice_gives_the_same_bytes(tmp_path: Path, fmi: int, plant: str) -> None:
    # In a new process with another hash seed, since sets are where order gets lost.
    script = "import sys, pathlib, fmu.build; "
    script += "fmu.build.build(sys.argv[1], int(sys.argv[2]), pathlib.Path(sys.argv[3]))"
    again = tmp_path / "again.fmu"
    run(
        [sys.executable, "-c", script, plant, str(fmi), str(again)],
        env=os.environ | {"PYTHONHASHSEED": "12345"},
    )
    assert again.read_bytes() == build.ensure(plant, fmi).read_bytes()


def rebuilt(original: Path, target: Path, folder: Path, compiler: str, flags: list[str]) -> Path:
    """Compile the sources that the FMU brings along, and exchange its binary."""
    with ZipFile(original) as archive:
        archive.extractall(folder)
        binary = next(name for name in archive.namelist() if name.startswith("binaries/"))
    units = re.findall(r'SourceFile name="([^"]+)"', (folder / "sources/buildDescription.xml").read_text())
    command = [compiler, "-std=c99", "-fPIC", "-shared", *flags, "-o", str(folder / binary), *units, "-lm"]
    run(command, cwd=folder / "sources")
    with ZipFile(target, "w", ZIP_DEFLATED) as archive:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                archive.write(path, path.relative_to(folder).as_posix())
    return target


def trace(path: Path) -> str:
    """Hash of all output bits over 0.3 s of wild voltages."""
    generator = np.random.default_rng(7)
    digest = hashlib.sha256()
    with FmuPlant(path, list(INPUTS), list(OUTPUTS), {"angle_lift": 40.0, "heading": 3.0}) as plant:
        for step in range(3000):
            if step % 50 == 0:
                for i, voltage in enumerate(generator.uniform(-24.0, 24.0, 4)):
                    plant.inputs[i] = float(voltage)
            plant.step()
            digest.update(bytes(plant.outputs))
    return digest.hexdigest()


def test_fmi_2_and_3_agree_bit_for_bit(fmu_file: dict[int, Path]) -> None:
    assert trace(fmu_file[2]) == trace(fmu_file[3])


@pytest.mark.long(keeps=["-O0-gcc"])
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("flags", ["-O0", "-O1", "-O2", "-O3", "-O3 -march=native"])
def test_every_compiler_gives_the_same_bits(
    fmu_file: dict[int, Path], tmp_path: Path, compiler: str, flags: str
) -> None:
    options = [*flags.split(), "-ffp-contract=off", "-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror"]
    other = rebuilt(fmu_file[3], tmp_path / "other.fmu", tmp_path / "unzipped", compiler, options)
    assert trace(other) == trace(fmu_file[3])


def test_the_reference_trajectory_still_holds(fmu_file: dict[int, Path]) -> None:
    written = np.loadtxt(reference.FILE, delimiter=",", skiprows=1)
    assert reference.FILE.read_text(encoding="utf-8").splitlines()[0].split(",") == ["time", *OUTPUTS]
    assert np.array(reference.rows(fmu_file[3])) == pytest.approx(written, rel=1e-7, abs=1e-9)


def test_own_sine_cosine_and_arc_tangent(tmp_path: Path) -> None:
    source = Path(build.__file__).parent / "export" / "c" / "elementary.h"
    wrapper = f'#include "{source}"\n' + "".join(
        f"double {name}(double x) {{ return fb_{name}(x); }}\n" for name in ("sine", "cosine", "arc_tangent")
    )
    (tmp_path / "own.c").write_text(wrapper)
    command = [
        find_compiler(),
        "-O2",
        "-ffp-contract=off",
        "-shared",
        "-fPIC",
        "-o",
        "own.so",
        "own.c",
        "-lm",
    ]
    run(command, cwd=tmp_path)
    library = ctypes.CDLL(str(tmp_path / "own.so"))
    generator = np.random.default_rng(1)
    angles = [*generator.uniform(-4, 4, 400), *generator.uniform(-1e6, 1e6, 400), 0.0, 1e6, -1e6]
    angles += [k * np.pi / 4 + d for k in range(-9, 10) for d in (-1e-9, 0.0, 1e-9)]
    slopes = [*generator.uniform(-3, 3, 400), *10.0 ** generator.uniform(-20, 20, 400), 0.0, 1.0, -1.0]
    for name, exact, arguments in (
        ("sine", mpmath.sin, angles),
        ("cosine", mpmath.cos, angles),
        ("arc_tangent", mpmath.atan, slopes),
    ):
        own = getattr(library, name)
        own.restype, own.argtypes = ctypes.c_double, [ctypes.c_double]
        for x in arguments:
            value = exact(mpmath.mpf(float(x)))
            assert abs(own(float(x)) - value) <= 1.5e-16 + 2.3e-16 * abs(value), (name, x)


def test_the_generated_c_calls_no_library_but_sqrt_and_fabs(fmu_file: dict[int, Path]) -> None:
    with ZipFile(fmu_file[3]) as archive:
        text = "".join(archive.read(f"sources/{name}.c").decode() for name in ("model", "tangents"))
    called = set(re.findall(r"(\w+)\(", re.sub(r'"[^"]*"', "", text)))
    ours = {name for name in called if name.startswith("fb_")}
    assert called - ours == {"sqrt", "fabs"}


def test_robot_file_and_plant_agree_on_the_geometry() -> None:
    starts = {row.name: row.start for row in PARAMETERS}
    found = PLANT.parameters_of(find("rars"))
    assert len(found) == len(ROBOT_FILE)
    for name, value in found.items():
        assert value == pytest.approx(starts[name]), name


def test_parameters_are_complete() -> None:
    names = [row.name for row in PARAMETERS]
    assert len(set(names)) == len(names)
    for overrides in SETS.values():
        assert set(overrides) <= set(names)
    for row in PARAMETERS:
        assert "assumed" in row.source or "[R]" in row.source


@pytest.fixture
def none_came(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Hide the plants of an installation, so that they are built here."""
    monkeypatch.setattr(ready, "FOLDER", tmp_path)


@pytest.mark.usefixtures("none_came")
def test_two_processes_may_build_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    # Forks of this process, which has loaded SymPy: nothing else takes longer.
    context = multiprocessing.get_context("fork")
    both = [context.Process(target=build.ensure, args=("single_axis", 3)) for _ in range(2)]
    for process in both:
        process.start()
    for process in both:
        process.join()
    assert [process.exitcode for process in both] == [0, 0]
    (found,) = (tmp_path / "firmware-bridge" / "fmu").iterdir()
    assert found == build.ensure("single_axis", 3)


@pytest.mark.usefixtures("none_came")
def test_no_compiler_is_one_clear_error(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(PlantError, match=r"no C compiler found \(tried cc, gcc, clang\): install one"):
        build.ensure("rars", 3)


@pytest.mark.usefixtures("none_came")
def test_a_plant_that_came_with_the_package_is_taken_as_long_as_its_sources_are_the_same(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    assert build.ensure("rars", 3).parent != tmp_path
    came = tmp_path / ready.file_name(PLANT, 3)
    build.place("rars", 3, came)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert build.is_built("rars", 3)
    assert build.ensure("rars", 3) == came
    with pytest.raises(PlantError, match="no C compiler"):
        build.ensure("rars", 2)
    monkeypatch.setattr(ready, "token_of", lambda _plant: "0" * 32)
    with pytest.raises(PlantError, match="no C compiler"):
        build.ensure("rars", 3)


@pytest.mark.usefixtures("none_came")
def test_without_sympy_a_plant_states_how_to_have_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def version(name: str) -> str:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(metadata, "version", version)
    build._libraries.cache_clear()  # noqa: SLF001 - it looks up the compiler only once
    with pytest.raises(PlantError, match=r"built with sympy, .*pip install 'firmware-bridge\[plants\]'"):
        build.ensure("rars", 3)


def test_unknown_model_and_version_are_refused(tmp_path: Path) -> None:
    with pytest.raises(PlantError, match=r"no plant 'mars'; did you mean 'rars'\? there are: .*rars"):
        build.build("mars", 3, tmp_path / "x.fmu")
    with pytest.raises(PlantError, match="FMI 1 is not offered"):
        build.build("rars", 1, tmp_path / "x.fmu")


def test_a_compiler_that_fails_states_why(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CC", "false")
    with pytest.raises(PlantError, match="failed"):
        build.build("single_axis", 3, tmp_path / "x.fmu")
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(PlantError, match="no-such-compiler was not found"):
        build.build("single_axis", 3, tmp_path / "x.fmu")
