"""Binaries for other machines, made by Debian's cross compilers, run under Wine and qemu-user: the same bits.

They are run by `pytest -m platforms`, a step of its own in `.ci/run`, and fail there where something is
missing; no other run of the tests has them.
"""

import hashlib
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from zipfile import ZipFile

import pytest
from fmpy.model_description import read_model_description

from fmu.build import ensure
from fmu.platforms import PLATFORMS, elsewhere, find_compiler, here
from fmu.verify import recorded
from hil_tests.fmu.instance import VERSIONS

DRIVER: Final = Path(__file__).with_name("fixed_run.c")
PLANTS: Final = ("rars", "single_axis")


@dataclass(frozen=True)
class Machine:
    """Runner of one platform's programs on this machine, and its package in Debian."""

    runner: tuple[str, ...]
    package: str
    libraries: tuple[str, ...] = ("-ldl",)


OWN: Final = Machine((), "")
MACHINES: Final = {
    "x86_64-windows": Machine(("/usr/lib/wine/wine64",), "wine64", ()),
    "aarch64-linux": Machine(("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"), "qemu-user"),
    "x86_64-linux": Machine(("qemu-x86_64", "-L", "/usr/x86_64-linux-gnu"), "qemu-user"),
}


def fixed_run(folder: Path, plant: str, fmi: int, name: str, machine: Machine) -> str:
    """Return the SHA-256 of what the fixed run of this platform's binary gives."""
    path = ensure(plant, fmi, elsewhere() if name != here().name else ())
    with ZipFile(path) as archive:
        archive.extractall(folder)
    platform = here() if name == here().name else next(one for one in PLATFORMS if one.name == name)
    program, compiler = folder / "fixed_run.exe", platform.compiler or find_compiler()
    words = [compiler, f"-DFMI={fmi}", "-o", str(program), str(DRIVER), *machine.libraries]
    subprocess.run(words, check=True)
    description, wanted = read_model_description(str(path)), recorded(path)
    assert wanted is not None
    references = {row.name: str(row.valueReference) for row in description.modelVariables}
    words = [f"{references[name]}:{nominal!r}" for name, nominal in wanted.inputs.items()]
    words += ["/", *(references[name] for name in wanted.outputs)]
    library = str(folder / platform.binary(plant, fmi))
    environment = os.environ | {"WINEPREFIX": str(folder.parent / "wine"), "WINEDEBUG": "-all"}
    done = subprocess.run(
        [*machine.runner, str(program), library, description.guid, repr(wanted.step / 1e9), *words],
        env=environment, capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr.decode(errors="replace")
    assert len(done.stdout) == 400 * 8 * len(wanted.outputs)
    return hashlib.sha256(done.stdout).hexdigest()


@VERSIONS
@pytest.mark.parametrize("plant", PLANTS)
def test_the_run_in_c_is_the_fixed_run(tmp_path: Path, plant: str, fmi: int) -> None:
    """The reference for the other machines, on this one."""
    wanted = recorded(ensure(plant, fmi))
    assert wanted is not None
    assert fixed_run(tmp_path / "own", plant, fmi, here().name, OWN) == wanted.sha256


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("platforms")


@pytest.mark.platforms
@VERSIONS
@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("name", [one.name for one in elsewhere()])
def test_another_machine_gives_the_same_bits(room: Path, name: str, plant: str, fmi: int) -> None:
    machine = MACHINES[name]
    for platform in elsewhere():
        assert shutil.which(platform.compiler), f"{platform.compiler} is missing: install {platform.package}"
    assert shutil.which(machine.runner[0]), f"{machine.runner[0]} is missing: install {machine.package}"
    folder = room / f"{plant}{fmi}-{name}"
    wanted = recorded(ensure(plant, fmi))
    assert wanted is not None
    assert fixed_run(folder, plant, fmi, name, machine) == wanted.sha256


@pytest.mark.platforms
@VERSIONS
def test_building_for_all_machines_twice_gives_the_same_bytes(
    tmp_path: Path, fmi: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = ensure("single_axis", fmi, elsewhere()).read_bytes()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert ensure("single_axis", fmi, elsewhere()).read_bytes() == first


LIBRARY: Final = {
    "stdlib.h": """
        #include <stddef.h>
        void *calloc(size_t, size_t);
        void *malloc(size_t);
        void free(void *);
    """,
    "string.h": """
        #include <stddef.h>
        void *memcpy(void *, const void *, size_t);
        void *memset(void *, int, size_t);
        int memcmp(const void *, const void *, size_t);
        int strcmp(const char *, const char *);
        size_t strlen(const char *);
    """,
    "math.h": """
        double sqrt(double);
        double fabs(double);
        double floor(double);
        int _finite(double);
        #define INFINITY ((float)(1e300 * 1e300))
        #define isfinite(x) _finite(x)
        #define isnan(x) ((x) != (x))
    """,
    "stdio.h": """
        #include <stdarg.h>
        #include <stddef.h>
        int vsnprintf(char *, size_t, const char *, va_list);
    """,
}
"""Declarations that our sources use of Microsoft's C library, whose headers exist only in Windows."""


@pytest.mark.platforms
@VERSIONS
@pytest.mark.parametrize("plant", PLANTS)
def test_the_sources_are_what_microsofts_compiler_reads(tmp_path: Path, plant: str, fmi: int) -> None:
    """Checked by clang in its manner: its keywords, macros and command line, no word of C99 promised."""
    with ZipFile(ensure(plant, fmi)) as archive:
        archive.extractall(tmp_path)
    for name, text in LIBRARY.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    units = sorted(str(path) for path in (tmp_path / "sources").glob("*.c"))
    manner = ("--target=x86_64-pc-windows-msvc", "--driver-mode=cl", "/U__STDC_VERSION__")
    requested = ("/c", "/Zs", "/W3", "/WX", "-Wno-unused", "-Wno-unknown-pragmas", f"-I{tmp_path}")
    assert len(units) > 8
    subprocess.run(["clang", *manner, *requested, *units], check=True)  # noqa: S607 - Debian's
