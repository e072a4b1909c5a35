"""The fingerprint: right in our own builds, and it detects a plant that was compiled to give other bits."""

import ctypes
import math
import re
import shutil
import struct
import subprocess
import sys
import warnings
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
import pytest

from fmu import build
from fmu.check import examine
from fmu.errors import PlantWarning
from fmu.export import reference_model
from fmu.export.blocks import ModelCode
from fmu.export.reference_model import fingerprint
from fmu.fingerprint import RESOURCE, Fingerprint
from fmu.plant import FmuPlant
from fmu.plants import find
from fmu.platforms import find_compiler
from fmu.rars.interface import INPUTS, OUTPUTS
from fmu.verify import ComparisonResult, recorded

COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
MISSION = """
title = "nothing"
duration_s = 0.2

[[step]]
at_s = 0.1
title = "arm"
arm = true
"""
HAS_FMA = "fma" in Path("/proc/cpuinfo").read_text(encoding="utf-8").split()


def run(command: list[str], folder: Path) -> None:
    subprocess.run(command, check=True, cwd=folder)


def compiled_otherwise(original: Path, target: Path, folder: Path, flags: str) -> Path:
    """Exchange the binary of an FMU by one that these flags give.

    Linked without them: a library that was linked with -ffast-math changes how the whole process rounds.
    """
    with ZipFile(original) as archive:
        archive.extractall(folder)
        binary = next(name for name in archive.namelist() if name.startswith("binaries/"))
    units = re.findall(r'SourceFile name="([^"]+)"', (folder / "sources/buildDescription.xml").read_text())
    compiler = find_compiler()
    run([compiler, "-std=c99", "-fPIC", "-c", *flags.split(), *units], folder / "sources")
    objects = [f"{Path(unit).stem}.o" for unit in units]
    run([compiler, "-shared", "-o", str(folder / binary), *objects, "-lm"], folder / "sources")
    with ZipFile(target, "w", ZIP_DEFLATED) as archive:
        for path in sorted(folder.rglob("*")):
            if path.is_file() and path.suffix != ".o":
                archive.write(path, path.relative_to(folder).as_posix())
    return target


@pytest.mark.parametrize("fmi", [2, 3])
def test_our_own_builds_give_the_bits_of_their_equations(fmu_file: dict[int, Path], fmi: int) -> None:
    with warnings.catch_warnings(), FmuPlant(fmu_file[fmi], list(INPUTS), list(OUTPUTS)) as plant:
        warnings.simplefilter("error")
        assert plant.fingerprint is ComparisonResult.SAME
        # It was taken beside this instance, which has not moved.
        assert plant.steps_done == 0
        assert plant.read("time") == 0.0


def test_the_parameters_of_a_run_do_not_matter(fmu_file: dict[int, Path]) -> None:
    with FmuPlant(fmu_file[3], list(INPUTS), ["speed"], {"platform_mass": 20.0}) as plant:
        assert plant.fingerprint is ComparisonResult.SAME


@pytest.fixture(
    scope="module",
    params=[
        "-O2 -ffast-math",
        pytest.param(
            "-O2 -ffp-contract=fast -march=native",
            marks=[
                pytest.mark.long(beside="test_the_program_states_so_in_one_line"),
                pytest.mark.skipif(not HAS_FMA, reason="this CPU does not fuse multiply and add"),
            ],
        ),
    ],
)
def other(
    request: pytest.FixtureRequest, fmu_file: dict[int, Path], tmp_path_factory: pytest.TempPathFactory
) -> Path:
    folder = tmp_path_factory.mktemp("other")
    return compiled_otherwise(fmu_file[3], folder / "other.fmu", folder / "unzipped", request.param)


@pytest.mark.long(beside="test_the_program_states_so_in_one_line")
def test_a_plant_that_was_compiled_otherwise_is_named(other: Path) -> None:
    with pytest.warns(PlantWarning, match=r"other\.fmu: this plant was compiled in another way") as caught:
        plant = FmuPlant(other, list(INPUTS), list(OUTPUTS))
    assert len(caught) == 1
    assert "\n" not in str(caught[0].message)
    # It works all the same.
    assert plant.fingerprint is ComparisonResult.OTHER
    plant.inputs[0] = 12.0
    for _ in range(100):
        plant.step()
    assert plant.read("speed_left") > 10.0
    plant.close()
    found = examine(other)
    assert found.fingerprint is ComparisonResult.OTHER
    assert [problem for problem in found.problems if "-ffp-contract=off" in problem]


def test_the_program_states_so_in_one_line(other: Path, tmp_path: Path) -> None:
    mission = tmp_path / "short.toml"
    mission.write_text(MISSION, encoding="utf-8")
    words = ["bench", "rars", "-m", str(mission), "--plant", str(other), "--out", str(tmp_path / "out")]
    # Without pictures: Matplotlib would take more time than the run.
    script = (
        "import sys, types; from firmware_bridge.cli import main; "
        "sys.modules['emulators.bench.plots'] = types.SimpleNamespace(draw=lambda *_, **__: []); main()"
    )
    result = subprocess.run(
        [sys.executable, "-c", script, *words], capture_output=True, text=True, check=False
    )
    first, *more = result.stderr.splitlines()
    assert first.startswith(f"firmware-bridge: warning: {other}: this plant was compiled in another way")
    # -ffast-math takes more than the last digits; then the run ends with a reason.
    assert (result.returncode, more) == (0, []) or "check the plant" in more[0]


@pytest.mark.long(beside="test_the_program_states_so_in_one_line")
def test_harmless_flags_are_harmless(fmu_file: dict[int, Path], tmp_path: Path) -> None:
    flags = "-O3 -march=native -ffp-contract=off"
    path = compiled_otherwise(fmu_file[3], tmp_path / "other.fmu", tmp_path / "unzipped", flags)
    assert examine(path).fingerprint is ComparisonResult.SAME


@pytest.mark.long(beside="test_the_program_states_so_in_one_line")
def test_one_bit_in_one_parameter_is_another_plant() -> None:
    model = find("rars").model()
    (first, *others) = model.parameters
    row = type(first)(first.name, first.start * (1 + 2**-52), first.unit, first.description, first.source)
    assert row.start != first.start
    changed = type(model)(**{
        name: getattr(model, name) for name in type(model).__slots__
    } | {"parameters": (row, *others)})  # fmt: skip
    one, other = fingerprint(ModelCode(model)), fingerprint(ModelCode(changed))
    assert one is not None
    assert other is not None
    assert one.sha256 != other.sha256


def test_both_versions_carry_the_same_fingerprint(fmu_file: dict[int, Path]) -> None:
    two, three = recorded(fmu_file[2]), recorded(fmu_file[3])
    assert two == three
    assert two is not None
    assert two.outputs == list(OUTPUTS)
    assert Fingerprint.from_json(two.to_json().encode()) == two


@pytest.mark.parametrize("text", [None, b"", b"[]", b'{"inputs": {}}', b"\xff"])
def test_a_foreign_node_has_none(fmu_file: dict[int, Path], tmp_path: Path, text: bytes | None) -> None:
    path = tmp_path / "bare.fmu"
    with ZipFile(fmu_file[3]) as source, ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for name in source.namelist():
            if name != RESOURCE:
                archive.writestr(name, source.read(name))
            elif text is not None:
                archive.writestr(name, text)
    with FmuPlant(path, list(INPUTS), list(OUTPUTS)) as plant:
        assert plant.fingerprint is ComparisonResult.NONE


def test_the_reference_s_functions_are_those_in_c_bit_for_bit(tmp_path: Path) -> None:
    header = Path(build.__file__).parent / "export" / "c" / "elementary.h"
    references = {
        "sine": reference_model.sine,
        "cosine": reference_model.cosine,
        "arc_tangent": reference_model.arc_tangent,
    }
    text = "".join(f"double {name}(double x) {{ return fb_{name}(x); }}\n" for name in references)
    text += "double angle(double y, double x) { return fb_angle(y, x); }\n"
    (tmp_path / "own.c").write_text(f'#include "{header}"\n{text}', encoding="utf-8")
    options = "-O2 -ffp-contract=off -shared -fPIC -o own.so own.c -lm"
    run([find_compiler(), *options.split()], tmp_path)
    library = ctypes.CDLL(str(tmp_path / "own.so"))
    generator = np.random.default_rng(2)
    arguments = [*generator.uniform(-9, 9, 2000), *generator.uniform(-1e6, 1e6, 2000), 0.0, -0.0, 1e-300]
    arguments += [k * np.pi / 8 for k in range(-40, 41)]
    for name, ours in references.items():
        native = getattr(library, name)
        native.restype, native.argtypes = ctypes.c_double, [ctypes.c_double]
        for x in map(float, arguments):
            assert struct.pack("d", ours(x)) == struct.pack("d", native(x)), (name, x)
    library.angle.restype, library.angle.argtypes = ctypes.c_double, [ctypes.c_double] * 2
    for y, x in zip(generator.uniform(-5, 5, 4000), 10.0 ** generator.uniform(-3, 1, 4000), strict=True):
        found = library.angle(float(y), float(x))
        assert struct.pack("d", reference_model.angle(float(y), float(x))) == struct.pack("d", found), (y, x)
        assert found == pytest.approx(math.atan2(y, x), rel=4e-16)
