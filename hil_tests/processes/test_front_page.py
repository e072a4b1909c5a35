"""The front page's doors and the tutorials: each line is run as it stands there, and prints what is shown."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

import pytest

from hil_tests.processes import tutorial
from hil_tests.processes.pair import awaited
from hil_tests.processes.tutorial import ROOT, Edit, steps

README: Final = (ROOT / "README.md").read_text(encoding="utf-8")
BINARIES: Final = Path(sys.executable).parent
REAL_BUS: Final = "-c can0"
"""In a line that needs an adapter: its options are read, and the bus is missed."""
DOORS: Final = tuple(re.findall(r"^## (I .*?)\n(.*?)(?=^## )", README, flags=re.DOTALL | re.MULTILINE))
TUTORIALS: Final = tuple(
    (page.stem, page.read_text(encoding="utf-8")) for page in sorted(tutorial.TUTORIALS.glob("*.md"))
)

TITLES: Final = [title for title, _ in (*DOORS, *TUTORIALS)]

pytestmark = pytest.mark.alone


class Shell:
    """A folder in which a door's lines are typed, one after the other."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        # A shell has what it starts in the background ignore Ctrl-C: the tests may be such, and hand it on.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        (folder / "examples").symlink_to(ROOT / "examples")
        self._environment = {
            **os.environ,
            "PATH": f"{BINARIES}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": str(folder / "site"),
            "PYTHONUNBUFFERED": "1",
            "XDG_STATE_HOME": str(folder / "state"),
            "COLUMNS": "120",
            "NO_COLOR": "1",
        }
        self._running: list[subprocess.Popen[str]] = []

    def writes(self, name: str, text: str) -> None:
        """Write a file of this name in the folder."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def types(self, line: str, shown: Sequence[str]) -> None:
        """Run a line; AssertionError where it does not print what is shown, line for line, in this order."""
        # The tests' own environment gets no package.
        line = re.sub(r"^pip install -e (\w+)", rf"{sys.executable} -m pip install {BESIDE} ./\1", line)
        log = self.folder / f"{len(list(self.folder.glob('*.log')))}.log"
        with log.open("w", encoding="utf-8") as output:
            process = subprocess.Popen(
                ["/bin/sh", "-c", f"exec {line.removesuffix('&')}"],
                cwd=self.folder,
                env=self._environment,
                stdout=output,
                stderr=subprocess.STDOUT,
                text=True,
            )
        if line.endswith("&"):
            self._running.append(process)
            awaited(lambda: prints(log.read_text(encoding="utf-8"), shown), f"{line} prints {shown}")
            return
        status = process.wait(timeout=300)
        printed = log.read_text(encoding="utf-8")
        if REAL_BUS in line:
            assert (status, "can0" in printed) == (2, True), printed
            return
        assert status == 0, printed
        assert prints(printed, shown), printed

    def ends(self) -> None:
        """End what still runs, as Ctrl-C does, the newest first: it may use what an older one provides."""
        for process in reversed(self._running):
            with suppress(ProcessLookupError):
                process.send_signal(signal.SIGINT)
            assert process.wait(timeout=60) == 0


BESIDE: Final = "--quiet --no-deps --no-build-isolation --disable-pip-version-check --target site"


def prints(printed: str, shown: Sequence[str]) -> bool:
    """Return whether these lines were printed in this order; `...` is anything, each number any."""
    lines = iter(printed.splitlines())
    return all(any(re.match(pattern(line), other) for other in lines) for line in shown)


def pattern(line: str) -> str:
    whole = re.escape(line.rstrip()).replace(r"\.\.\.", ".*")
    # A longer number leaves fewer spaces in front of it.
    return re.sub(r"(?<!x)(?<![\dA-F])\d+(?![\dA-Fx])", r"\\d+", re.sub(r"(\\ )+", " +", whole))


@contextmanager
def shell(folder: Path) -> Iterator[Shell]:
    made = Shell(folder)
    try:
        yield made
    finally:
        made.ends()


@pytest.mark.parametrize(("title", "text"), [*DOORS, *TUTORIALS], ids=TITLES)
def test_what_is_typed_prints_what_is_shown(title: str, text: str, tmp_path: Path) -> None:
    assert title
    with shell(tmp_path) as typed:
        for step in steps(text):
            if isinstance(step, Edit):
                typed.writes(step.name, step.text)
            else:
                typed.types(step.line, step.shown)


def test_there_are_four_doors() -> None:
    assert len(DOORS) == 4
    assert TUTORIALS
