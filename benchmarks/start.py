"""How soon the program and the pytest fixture `rig` are there."""

import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Final

from benchmarks.figure import Figure
from benchmarks.reference import loop_ms

HELP: Final = "import sys; sys.argv[1:] = ['--help']; from firmware_bridge.cli import main; main()"
TYPER: Final = "import typer, rich.console"
RIG: Final = """
import time
import emulators.rig, fmu.loading, fmu.verify
from emulators.devices import needs_of
from emulators.testing.kept import Kept
from firmware_bridge.robot_types import find
needs_of(find({robot!r}))
kept, begun = Kept(), time.process_time()
kept.armed({robot!r}, 0)
print(1e3 * (time.process_time() - begun))
"""
ROBOTS: Final = ("rars", "rome")
REPEATS: Final = 5
RIG_MS: Final = 50.0
HELP_RATIO: Final = 1.5


def figures() -> Iterator[Figure]:
    """Measure both: each the least of some new processes."""
    helped, imported = (min(_started_ms(text) for _ in range(REPEATS)) for text in (HELP, TYPER))
    yield Figure(
        name="firmware-bridge --help",
        value=helped,
        unit="ms",
        against="import typer, rich.console",
        reference=imported,
        goal=HELP_RATIO,
    )
    loop = loop_ms()
    for robot in ROBOTS:
        armed = min(float(_printed(RIG.format(robot=robot))) for _ in range(REPEATS))
        yield Figure(
            name=f"rig in pytest, the first, {robot}",
            value=armed,
            unit="ms",
            against="loop",
            reference=loop,
            goal=RIG_MS / loop,
        )


def _started_ms(text: str) -> float:
    """Return the time of a whole process, ms."""
    begun = time.perf_counter()
    _printed(text)
    return 1e3 * (time.perf_counter() - begun)


def _printed(text: str) -> str:
    words = [sys.executable, "-P", "-c", text]
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout  # noqa: S603 - ours
