"""Machines that a plant's binary may be for, and the compilers that make it: this one, and those across.

Plants are not known here: files of C go in, a library comes out, or a sentence on what is missing.
"""

import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

from fmu.errors import PlantError

FLAGS: Final = (
    "-std=c99", "-O3", "-fno-guess-branch-probability", "-fno-math-errno", "-fno-trapping-math",
    "-ffp-contract=off", "-fPIC", "-fvisibility=hidden",
)  # fmt: skip
"""Compiler flags for the same bits on every machine.

The code uses neither errno nor traps, and without them roots and choices take no branches; the bits are the
same. gcc guesses on which side of a bound a value lies, and moves the other side away: 7 % of a run's time.
Contraction into fused multiply-adds would make the result depend on compiler and CPU.
"""

_COMPILERS: Final = ("cc", "gcc", "clang")


@dataclass(frozen=True, slots=True)
class Platform:
    """A kind of machine: its tuple (FMI 3.0.2, 2.5.1.4.1), its folder in FMI 2.0, how its libraries end.

    `compiler` makes them on another machine, `package` is where Debian has it, `flags` are its own.
    """

    name: str
    folder: str
    suffix: str
    compiler: str
    package: str
    flags: tuple[str, ...] = ()

    def binary(self, identifier: str, fmi: int) -> str:
        """Return the path of the library in an FMU."""
        return f"binaries/{self.folder if fmi < 3 else self.name}/{identifier}{self.suffix}"  # noqa: PLR2004 - the version


PLATFORMS: Final = (
    Platform("x86_64-linux", "linux64", ".so", "x86_64-linux-gnu-gcc", "gcc-x86-64-linux-gnu"),
    Platform(
        "x86_64-windows", "win64", ".dll", "x86_64-w64-mingw32-gcc", "gcc-mingw-w64-x86-64",
        # Nothing beside it has to be installed there, and two builds are the same bytes.
        ("-static-libgcc", "-Wl,--no-insert-timestamp"),
    ),
    # FMI 2.0.5 takes the tuples of FMI 3.0 for what it has no name for.
    Platform(
        "aarch64-linux", "aarch64-linux", ".so", "aarch64-linux-gnu-gcc",
        "gcc-aarch64-linux-gnu and libc6-dev-arm64-cross",
    ),
)  # fmt: skip
"""Platforms for which an FMU carries a binary, where the compiler is."""


def here() -> Platform:
    """Return this machine's platform. Its folder in FMI 2.0 is what FMPy looks into, on ARM, too."""
    system, short, suffix = {
        "darwin": ("darwin", "darwin", ".dylib"),
        "win32": ("windows", "win", ".dll"),
    }.get(sys.platform, ("linux", "linux", ".so"))
    machine = platform.machine().lower()
    # Windows and macOS name the same processors otherwise than FMI does.
    architecture = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)
    return Platform(f"{architecture}-{system}", f"{short}64", suffix, "", "")


def elsewhere() -> tuple[Platform, ...]:
    """Return the other platforms that an FMU may carry a binary for."""
    mine = here()
    return tuple(one for one in PLATFORMS if one.name != mine.name and one.folder != mine.folder)


def reachable() -> tuple[tuple[Platform, ...], tuple[Platform, ...]]:
    """Return the other platforms that have a compiler on this machine, and those that have none."""
    found = tuple(one for one in elsewhere() if shutil.which(one.compiler))
    return found, tuple(one for one in elsewhere() if one not in found)


def find_compiler() -> str:
    """Return the path of a C compiler for this machine: $CC, else the first of cc, gcc, clang."""
    chosen = os.environ.get("CC")
    for name in (chosen,) if chosen else _COMPILERS:
        path = shutil.which(name)
        if path:
            return path
    if chosen:
        raise PlantError(f"the C compiler $CC = {chosen} was not found: correct it, or unset CC")
    raise PlantError(f"no C compiler found (tried {', '.join(_COMPILERS)}): install one, e.g. Debian's gcc")


@cache
def version_text(compiler: str) -> bytes:
    """Return a compiler's version text, read once: another version may give another binary."""
    # The compiler is the user's own choice.
    return subprocess.run([compiler, "--version"], capture_output=True, check=False).stdout  # noqa: S603


def library(
    files: Mapping[str, str], units: Sequence[str], compiler: str, flags: Sequence[str] = ()
) -> bytes:
    """Compile the C files `units` among `files` into one library; PlantError with the compiler's output."""
    with tempfile.TemporaryDirectory(prefix="firmware-bridge-build-") as name:
        folder = Path(name)
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")
        # Relative names, so that no path of this machine gets into the binary.
        command = [compiler, *FLAGS, *flags, "-shared", "-s", "-o", "plant.library", *units, "-lm"]
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)  # noqa: S603
        if run.returncode:
            raise PlantError(f"{' '.join(command)} failed:\n{run.stderr.strip()}")
        return (folder / "plant.library").read_bytes()
