"""The C sources in someone else's hands: two models in one program, and compilers with other keywords."""

import re
import struct
import subprocess
from pathlib import Path
from typing import Final
from zipfile import ZipFile

import pytest
from fmpy.model_description import read_model_description

from fmu.build import ensure
from fmu.plant import FmuPlant
from fmu.platforms import find_compiler
from hil_tests.fmu.instance import VERSIONS

MODELS: Final = ("single_axis", "rome_base")
MAIN: Final = {
    2: """
  void *PREFIX(fmi2Instantiate)(const char *, int, const char *, const char *, const void *, int, int);
  int PREFIX(fmi2SetupExperiment)(void *, int, double, double, int, double);
  int PREFIX(fmi2EnterInitializationMode)(void *);
  int PREFIX(fmi2ExitInitializationMode)(void *);
  int PREFIX(fmi2SetReal)(void *, const unsigned *, size_t, const double *);
  int PREFIX(fmi2DoStep)(void *, double, double, int);
  int PREFIX(fmi2GetReal)(void *, const unsigned *, size_t, double *);
  void *plant = PREFIX(fmi2Instantiate)("one", 1, TOKEN, "", NULL, 0, 0);
  int bad = PREFIX(fmi2SetupExperiment)(plant, 0, 0.0, 0.0, 0, 0.0);
  bad |= PREFIX(fmi2EnterInitializationMode)(plant) | PREFIX(fmi2ExitInitializationMode)(plant);
  bad |= PREFIX(fmi2SetReal)(plant, &in, 1, &volts) | PREFIX(fmi2DoStep)(plant, 0.0, 0.1, 0);
  bad |= PREFIX(fmi2GetReal)(plant, &out, 1, &value);
""",
    3: """
  void *PREFIX(fmi3InstantiateCoSimulation)(const char *, const char *, const char *, bool, bool, bool, bool,
                                            const unsigned *, size_t, void *, void *, void *);
  int PREFIX(fmi3EnterInitializationMode)(void *, bool, double, double, bool, double);
  int PREFIX(fmi3ExitInitializationMode)(void *);
  int PREFIX(fmi3SetFloat64)(void *, const unsigned *, size_t, const double *, size_t);
  int PREFIX(fmi3DoStep)(void *, double, double, bool, bool *, bool *, bool *, double *);
  int PREFIX(fmi3GetFloat64)(void *, const unsigned *, size_t, double *, size_t);
  bool a, b, c;
  double last;
  void *plant = PREFIX(fmi3InstantiateCoSimulation)("one", TOKEN, "", 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL);
  int bad = PREFIX(fmi3EnterInitializationMode)(plant, 0, 0.0, 0.0, 0, 0.0);
  bad |= PREFIX(fmi3ExitInitializationMode)(plant) | PREFIX(fmi3SetFloat64)(plant, &in, 1, &volts, 1);
  bad |= PREFIX(fmi3DoStep)(plant, 0.0, 0.1, 0, &a, &b, &c, &last);
  bad |= PREFIX(fmi3GetFloat64)(plant, &out, 1, &value, 1);
""",
}
ONE: Final = """
#undef PREFIX
#define PREFIX(name) MODEL_##name
static int MODEL(void) {
  const unsigned in = INPUT, out = OUTPUT;
  const double volts = 6.0;
  double value = 0.0;
BODY
  fwrite(&value, sizeof value, 1, stdout);
  return bad;
}
"""


def unpacked(model: str, fmi: int, folder: Path) -> list[Path]:
    """Unzip the sources of a model; return those that are compiled."""
    with ZipFile(ensure(model, fmi)) as archive:
        for name in archive.namelist():
            if name.startswith("sources/"):
                archive.extract(name, folder)
    return sorted((folder / "sources").glob("*.c"))


def run(*words: object, cwd: Path | None = None) -> None:
    subprocess.run([str(word) for word in words], check=True, cwd=cwd)


@pytest.mark.long(keeps=["3"])
@VERSIONS
def test_two_models_link_into_one_program(tmp_path: Path, fmi: int) -> None:
    compiler, text, wanted = find_compiler(), "#include <stdbool.h>\n#include <stdio.h>\n", []
    libraries = []
    for model in MODELS:
        folder = tmp_path / model
        units = unpacked(model, fmi, folder)
        options = ["-std=c99", "-O1", "-ffp-contract=off", f"-DFMI{fmi}_FUNCTION_PREFIX={model}_", "-c"]
        run(compiler, *options, *units, cwd=folder)
        libraries += sorted(folder.glob("*.o"))
        path = ensure(model, fmi)
        description = read_model_description(str(path))
        rows = {row.name: row for row in description.modelVariables}
        voltage = next(name for name in rows if name.startswith("voltage_"))
        speed = voltage.replace("voltage", "speed")
        values = {
            "MODEL": model,
            "INPUT": rows[voltage].valueReference,
            "OUTPUT": rows[speed].valueReference,
            "BODY": MAIN[fmi],
            "TOKEN": f'"{description.guid}"',
        }
        one = ONE
        for word, value in values.items():
            one = one.replace(word, str(value))
        text += one
        with FmuPlant(path, [voltage], [speed], step=100_000_000) as plant:
            plant.inputs[0] = 6.0
            plant.step()
            wanted.append(plant.outputs[0])
    text += f"int main(void) {{ return {' | '.join(f'{model}()' for model in MODELS)}; }}\n"
    (tmp_path / "main.c").write_text(text, encoding="utf-8")
    run(compiler, "-std=c99", "-o", tmp_path / "both", tmp_path / "main.c", *libraries, "-lm")
    done = subprocess.run([tmp_path / "both"], capture_output=True, check=True)
    found = struct.unpack("2d", done.stdout)
    assert found == tuple(wanted)
    assert min(found) > 1.0


@pytest.mark.long(keeps=["3"])
@VERSIONS
def test_every_name_outside_has_the_models_name_in_front(tmp_path: Path, fmi: int) -> None:
    units = unpacked("single_axis", fmi, tmp_path)
    run(find_compiler(), "-c", f"-DFMI{fmi}_FUNCTION_PREFIX=single_axis_", *units, cwd=tmp_path)
    listed = subprocess.run(
        ["nm", "-g", "--defined-only", *tmp_path.glob("*.o")],  # noqa: S607 - it comes with the compiler
        capture_output=True,
        text=True,
        check=True,
    )
    names = re.findall(r"^[0-9a-f]+ [A-Z] (\w+)$", listed.stdout, flags=re.MULTILINE)
    assert len(names) > 80
    assert [name for name in names if not name.startswith(("single_axis_fb_", f"single_axis_fmi{fmi}"))] == []


@VERSIONS
@pytest.mark.parametrize("model", ["rars", "single_axis"])
def test_compilers_that_know_neither_inline_nor_restrict_build_it(
    tmp_path: Path, model: str, fmi: int
) -> None:
    """C of 1990 knows neither word, nor arrays of a length of its own: as MSVC, which has others for both."""
    units = unpacked(model, fmi, tmp_path)
    run(find_compiler(), "-std=c90", "-Werror=vla", "-fsyntax-only", *units, cwd=tmp_path)


@VERSIONS
def test_no_word_is_gccs_own(tmp_path: Path, fmi: int) -> None:
    for path in [*unpacked("single_axis", fmi, tmp_path), *(tmp_path / "sources").glob("*.h")]:
        if path.name.startswith("fmi") and path.suffix == ".h" and "shell" not in path.name:
            continue  # FMI's own headers know MSVC
        text = re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        if path.name == "compiler.h":
            assert "_MSC_VER" in text
        else:
            found = re.findall(
                r"\b(?:__attribute__|__builtin_\w+|typeof|_Complex|alloca|__inline|__restrict|_Generic)\b",
                text,
            )
            assert found == [], path.name
