"""Comparison of the bytes of other interpreters and compilers, each in an environment of its own.

`python tools/same_trace.py [PYTHON ...] [--cc COMPILER ...]`; without names it takes every Python from 3.11
on that is on the path or that pyenv has, and whichever of gcc and clang there is. The package is installed
from a copy of its sources, as a user would, without what its tests need. Kernel and plant are then built by
that compiler, and the golden traces are driven with the kernel and with its reference implementation. It
exits with 1 where any differ. With FIRMWARE_BRIDGE_COMPILE=1 in the environment the core is compiled, too.
"""

# ruff: noqa: INP001, T201, S603 - a script, not a package; it prints; it runs programs that it is given

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[1]
SCRIPT: Final = ROOT / "tools" / "golden_traces.py"
GOLDEN: Final = ROOT / "hil_tests" / "golden" / "traces.json"
FILES: Final = ("pyproject.toml", "setup.py", "README.md", "LICENSE")
PACKAGES: Final = ("firmware_bridge", "emulators", "fmu")
BUILT: Final = shutil.ignore_patterns("*.so", "*.dll", "__pycache__")
COMPILERS: Final = ("gcc", "clang")
SERVOS: Final = {"native": "kernel", "reference": "reference implementation"}
"""Value of the environment variable, and the engine that then reports that it served."""
OLDEST: Final = (3, 11)
NAMES: Final = tuple(f"python3.{minor}" for minor in range(OLDEST[1], OLDEST[1] + 8))
REPORT_VERSION: Final = "import sys; print('%d.%d.%d' % sys.version_info[:3])"


class FailedError(Exception):
    """A command failed; the message holds the end of its output."""


@dataclass(frozen=True, slots=True)
class Interpreter:
    """A Python, and its version for people."""

    path: str
    version: str

    @property
    def fits(self) -> bool:
        """True if the package supports it."""
        major, minor, *_ = (int(part) for part in self.version.split("."))
        return (major, minor) >= OLDEST


def stated(command: Sequence[str], environment: Mapping[str, str] = os.environ) -> tuple[str, str]:
    """Run a command; return its output from both streams. FailedError where it fails."""
    try:
        run = subprocess.run(command, env=dict(environment), capture_output=True, text=True, check=False)
    except OSError as error:
        raise FailedError(f"{command[0]}: {error.strerror}") from error
    if run.returncode:
        raise FailedError((run.stderr.strip() or f"exit status {run.returncode}").splitlines()[-1])
    return run.stdout.strip(), run.stderr.strip()


def interpreter(path: str) -> Interpreter:
    """Return a Python with its version."""
    return Interpreter(path, stated([path, "-c", REPORT_VERSION])[0])


def found() -> list[Interpreter]:
    """Return one Python of each version that is here and fits."""
    pyenv = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv")
    paths = [path for name in NAMES if (path := shutil.which(name))]
    paths += [str(path) for path in sorted(pyenv.glob("versions/3.*/bin/python"))]
    by_version: dict[str, Interpreter] = {}
    for path in paths:
        try:
            one = interpreter(path)
        except FailedError:
            continue
        if one.fits:
            by_version.setdefault(one.version, one)
    return list(by_version.values())


def copied(folder: Path) -> Path:
    """Copy what is installed, without what was built before: it may be another compiler's work."""
    folder.mkdir()
    for name in FILES:
        shutil.copy(ROOT / name, folder)
    for name in PACKAGES:
        shutil.copytree(ROOT / name, folder / name, ignore=BUILT)
    return folder


class Environment:
    """An interpreter's own environment in a folder that someone else removes."""

    def __init__(self, one: Interpreter, folder: Path) -> None:
        self._folder = folder
        stated([one.path, "-m", "venv", str(folder / "venv")])
        self._python = str(folder / "venv" / "bin" / "python")
        self._installed = False

    def build(self, compiler: str) -> None:
        """Install the package as this compiler builds it; what it needs is installed once."""
        sources = copied(self._folder / f"sources-{compiler}")
        pip = [self._python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        again = ["--no-deps", "--force-reinstall"] if self._installed else []
        stated([*pip, *again, f"{sources}[plants]"], os.environ | {"CC": compiler})
        self._installed = True
        kernel = next(self._folder.glob("venv/lib/python*/site-packages/emulators/servo/libservo.so"), None)
        if kernel is None:
            raise FailedError(f"{compiler} built no kernel")
        if (b"clang version" in kernel.read_bytes()) is not ("clang" in compiler):
            raise FailedError(f"the kernel was built by another compiler than {compiler}")

    def traces(self, compiler: str, servo: str) -> tuple[dict[str, str], str]:
        """Drive the golden traces; return the hashes, and in words where packets differ.

        The plant is built by this compiler, too.
        """
        chosen = {"CC": compiler, "FIRMWARE_BRIDGE_SERVO": servo}
        cache = {"XDG_CACHE_HOME": str(self._folder / f"cache-{compiler}")}
        hashes, remarks = stated([self._python, str(SCRIPT)], os.environ | chosen | cache)
        *packets, served = remarks.splitlines()
        if served != SERVOS[servo]:
            raise FailedError(f"the {SERVOS[servo]} did not serve")
        traces: dict[str, str] = json.loads(hashes)
        return traces, "\n".join(packets)


def difference(traces: Mapping[str, str], golden: Mapping[str, str]) -> str:
    """Name what is not as the golden traces say; empty where all is."""
    return ", ".join(name for name in sorted({*traces, *golden}) if traces.get(name) != golden.get(name))


def compare(one: Interpreter, compilers: Sequence[str], golden: Mapping[str, str]) -> bool:
    """Print a line for each compiler and servo; return whether all are the same."""
    same = True
    with tempfile.TemporaryDirectory(prefix="same-trace-") as folder:
        rows = [(compiler, servo) for compiler in compilers for servo in SERVOS]
        environment: Environment | None = None
        built = ""
        for compiler, servo in rows:
            packets = ""
            try:
                environment = environment or Environment(one, Path(folder))
                if compiler != built:
                    environment.build(compiler)
                    built = compiler
                traces, packets = environment.traces(compiler, servo)
                other = difference(traces, golden)
                verdict = f"differs: {other}" if other else "same bytes"
            except FailedError as failure:
                other = verdict = f"failed: {failure}"
            print(f"Python {one.version:8s} {compiler:8s} {SERVOS[servo]:8s} {verdict}", flush=True)
            if packets:
                print(packets, flush=True)
            same = same and not other
    return same


def main() -> int:
    """Compare all; 1 where something differs or fails."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("python", nargs="*", help="interpreters; without any, all that are found")
    parser.add_argument("--cc", action="append", help="a C compiler; may be given more than once")
    requested = parser.parse_args()
    golden = json.loads(GOLDEN.read_text(encoding="utf-8"))
    try:
        interpreters = [interpreter(path) for path in requested.python] or found()
    except FailedError as failure:
        parser.error(str(failure))
    compilers = requested.cc or [name for name in COMPILERS if shutil.which(name)]
    results = [compare(one, compilers, golden) for one in interpreters]
    return 0 if results and all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
