# ruff: noqa: INP001 - a script's neighbor, not a package
"""Commands of a night, as a table, and the result of each command, in a file that is committed."""

import json
import os
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent
OUTCOMES: Final = Path(__file__).with_name("nightly_results.toml")
OWN: Final = ("tools/nightly_results.toml", "tools/mutate_results.toml", "docs/nightly.md")
"""Files that a night writes: no source of it."""
PYTEST: Final = ".venv/bin/python -m pytest -q -p no:cacheprovider"
COMPILED: Final = ".venv/compiled/bin/python -P -m"
STABILITY: Final = f"{COMPILED} hil_tests.stability"
SHARES: Final = 20
HEAD: Final = (
    "# What came of each command of a night, written by tools/nightly.py; docs/nightly.md is made from it.\n"
)


@dataclass(frozen=True, slots=True)
class Step:
    """One row of the night."""

    name: str
    what: str
    commands: tuple[str, ...]


def _adversary(robot: str, profiles: str, hours: float) -> str:
    # Other evenings with each commit.
    seed = "$((0x$(git rev-parse --short=6 HEAD)))"
    return f"make adversary ROBOT='{robot}' PROFILES='{profiles}' HOURS={hours} SEED={seed}"


STEPS: Final = (
    Step(
        "platforms",
        "FMUs for 64-bit Windows and ARM, built with cross compilers and run under Wine and qemu",
        (f"{PYTEST} -p no:xdist -m platforms hil_tests/fmu/test_platforms.py",),
    ),
    Step(
        "avr",
        "a sketch's binary in simavr beside the emulated board",
        (f"{PYTEST} -n 2 -m avr hil_tests/interop/simavr",),
    ),
    Step(
        "browser",
        "a tour of the live page in headless Chromium",
        (f"{PYTEST} -p no:xdist -m browser hil_tests/live/test_tour.py",),
    ),
    Step(
        "wheels",
        "what is published: both wheels, the sources, the list of what is installed",
        (f"make wheels && {PYTEST} -p no:xdist -m released hil_tests/installed",),
    ),
    Step(
        "long",
        "the long lane, whole",
        tuple(f"make long SHARE={number}/{SHARES}" for number in range(1, SHARES + 1)),
    ),
    Step(
        "adversary",
        "20 simulated hours in which operators, links and devices are as bad as they may be",
        (
            _adversary("rars", "honest", 4),
            _adversary("rars", "honest lying foreign", 3),
            _adversary("rars --serial v2", "honest", 2),
            _adversary("diff_drive", "honest lying foreign", 1),
            _adversary("servo_axis", "honest lying foreign", 1),
            _adversary("rome", "honest", 2),
            _adversary("rome+cameras", "honest lying", 1),
            _adversary("rome --protocol mw --encoders 3", "honest", 1),
            _adversary("climber", "honest", 2),
            _adversary("ar2", "honest", 1),
            _adversary("rome_arm", "honest", 2),
        ),
    ),
    Step(
        "stability",
        "10,000 manoeuvres on slopes, and 1,000 near the limits: RARS with its governor, and without it",
        (
            *(f"{STABILITY} usual --first {first} --count 1000" for first in range(0, 10_000, 1_000)),
            f"{STABILITY} hard",
        ),
    ),
    Step(
        "fuzz", "any frames sent to a drive by another node, the current of its motor watched", ("make fuzz",)
    ),
    Step(
        "compare-sketch",
        "the same lines sent to a sketch's binary and to the emulated board",
        ("make compare-sketch",),
    ),
    Step(
        "day",
        "a simulated day of RARS, recorded, whose memory stays as it is; how much a core drives in an hour",
        (f"{COMPILED} benchmarks.memory 1440", f"{COMPILED} benchmarks.hours"),
    ),
    Step(
        "under-load",
        "300 runs of the stories in real time beside six programs that compute without end",
        ("tools/with-loopback .venv/bin/python tools/under_load.py",),
    ),
    Step("site", "the documentation as a site, every warning an error", ("make site",)),
    Step(
        "mutation", "the program, broken in one place at a time", (".venv/bin/python tools/mutate.py -j 2",)
    ),
)


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of one command."""

    commit: str
    source: str
    """A hash of all files but those that a night writes."""
    on: str
    """The day, UTC."""
    seconds: int
    passed: bool
    result: str


def read() -> dict[str, Outcome]:
    """Return what is known, by command."""
    if not OUTCOMES.exists():
        return {}
    rows = tomllib.loads(OUTCOMES.read_text(encoding="utf-8")).get("command", [])
    return {row.pop("command"): Outcome(**row) for row in rows}


def write(outcomes: Mapping[str, Outcome]) -> None:
    """Write all of it at once, or nothing; what is no command any more is left out."""
    commands = [command for step in STEPS for command in step.commands if command in outcomes]
    text = HEAD
    for command in commands:
        text += "\n[[command]]\n"
        for key, value in {"command": command, **asdict(outcomes[command])}.items():
            text += f"{key} = {json.dumps(value)}\n"
    new = OUTCOMES.with_suffix(".new")
    new.write_text(text, encoding="utf-8")
    os.replace(new, OUTCOMES)  # noqa: PTH105 - one step
