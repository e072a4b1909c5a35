# ruff: noqa: INP001 - a script, not a package
"""Mutation campaign: break the safety code in one place at a time; its tests must notice every time.

Run it as `python tools/mutate_safety.py [-j N] [-k TEXT]`. It exits with 1 when a mutant survives that is not
in `tools/mutate_survivors.toml`, or when that list names one that does not.

Each mutant runs in a fork of this process, which has imported everything that is not mutated; only the fast
tests of the mutated module run, and the first failure ends the run.
"""

import argparse
import importlib.abc
import importlib.machinery
import os
import signal
import sys
import time
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from types import CodeType, ModuleType
from typing import Final

import pytest
from mutants import ROOT, Mutant, mutants, path_of

import firmware_bridge.motion.davis
import firmware_bridge.motion.scissor
import firmware_bridge.robot
import firmware_bridge.wire.cia402
import firmware_bridge.wire.epos2.rows  # noqa: F401 - all of these: paid for once, before the forks

SURVIVORS: Final = ROOT / "tools" / "mutate_survivors.toml"
TIMEOUT_S: Final = 30
GATE_TESTS: Final = (
    "safety/test_gate_lift.py",
    "safety/test_gate_limits.py",
    "safety/test_gate_stops.py",
)
GUARD_TESTS: Final = (
    "safety/test_guard_power.py",
    "safety/test_guard_watch.py",
    "safety/test_guard_frames.py",
    "safety/test_guard_writes.py",
    "safety/test_guard_reports.py",
)
GUARD_SERIAL_TESTS: Final = ("safety/test_guard_serial.py", "safety/test_guard_serial_answers.py")
ACROSS_TESTS: Final = (
    "safety/test_guard_exclusive.py",
    "safety/test_guard_links.py",
    "safety/test_guard_sums.py",
)
QUICK: Final = ("-x", "-q", "--tb=no", f"--rootdir={ROOT}", "-pno:cacheprovider", "-pno:xdist")
WARM_UP: Final = ROOT / "hil_tests/unit/motion/test_davis.py"
"""Needs nothing that is mutated: running it once makes every fork's pytest quick."""
TARGETS: Final = {
    "motion/ramp": ("unit/motion/test_ramp.py",),
    "safety/common": GATE_TESTS[::-1],
    "safety/following": ("safety/test_following.py",),
    "safety/rules": ("robots/test_every_robot.py", "unit/pipeline/test_rest.py"),
    "safety/limits": GATE_TESTS,
    "safety/gate": GATE_TESTS,
    "robots/rars/rules": GATE_TESTS,
    "safety/guard/guard": GUARD_TESTS + GUARD_SERIAL_TESTS + ACROSS_TESTS,
    "safety/guard/across_axes": ACROSS_TESTS,
    "safety/guard/axis": GUARD_TESTS + ACROSS_TESTS,
    "safety/guard/bounds": ("safety/test_guard_bounds.py",),
    "safety/guard/epos2_can": GUARD_TESTS + ACROSS_TESTS,
    "safety/guard/epos2_serial": (*GUARD_SERIAL_TESTS, "safety/test_guard_reports.py", *ACROSS_TESTS),
    "safety/guard/epos2_words": GUARD_TESTS[::-1],
    "safety/guard/writes": GUARD_TESTS[::-1] + GUARD_SERIAL_TESTS,
}
"""Modules of `firmware_bridge`, and the tests of `hil_tests` that must kill their mutants."""


class _Loader(importlib.machinery.SourceFileLoader):
    """Loads the mutant in place of the module."""

    def __init__(self, name: str, mutant: Mutant) -> None:
        super().__init__(name, str(path_of(mutant.target)))
        self._mutant = mutant

    def get_code(self, fullname: str) -> CodeType:
        del fullname
        return compile(self._mutant.tree(), self.path, "exec")


class _Finder(importlib.abc.MetaPathFinder):
    """Finds the mutant before the module."""

    def __init__(self, loader: _Loader) -> None:
        self._loader = loader

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        del path, target
        if fullname != self._loader.name:
            return None
        return importlib.machinery.ModuleSpec(fullname, self._loader, origin=self._loader.path)


def begin(target: str, mutant: Mutant | None = None) -> int:
    """Fork a run of the module's tests against a mutant of it, or against itself; return its process."""
    sys.stdout.flush()
    child = os.fork()
    if child:
        return child
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    signal.alarm(TIMEOUT_S)
    if mutant is not None:
        name = "firmware_bridge." + target.replace("/", ".")
        sys.meta_path.insert(0, _Finder(_Loader(name, mutant)))
    files = [str(ROOT / "hil_tests" / file) for file in TARGETS[target]]
    try:
        status = int(pytest.main([*QUICK, *files]))
    except BaseException:  # noqa: BLE001 - a mutant may fail in any way, and all of them are noticed
        status = 1
    os._exit(status)


def survivors(chosen: Iterable[Mutant], jobs: int) -> Iterator[Mutant]:
    """Run all mutants, `jobs` at a time; yield those whose tests passed."""
    running: dict[int, Mutant] = {}

    def ended() -> Iterator[Mutant]:
        child, status = os.wait()
        mutant = running.pop(child)
        if status == 0:
            yield mutant

    for mutant in chosen:
        if len(running) >= jobs:
            yield from ended()
        running[begin(mutant.target, mutant)] = mutant
    while running:
        yield from ended()


def listed() -> dict[tuple[str, str, str], str]:
    """Return the known survivors and why nothing can notice them."""
    rows = tomllib.loads(SURVIVORS.read_text(encoding="utf-8")).get("survivor", [])
    return {(row["module"], row["code"], row["change"]): row["reason"] for row in rows}


def say(text: str) -> None:
    """Tell the user at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def sound(when: str) -> bool:
    """Return whether all tests pass while nothing is broken."""
    failed = [target for target in TARGETS if os.waitpid(begin(target), 0)[1] != 0]
    for target in failed:
        say(f"{target}: its tests fail {when} the campaign, with nothing broken")
    return not failed


def main() -> int:
    """Run the campaign and say what came of it."""
    parser = argparse.ArgumentParser(description="Break the safety code in one place at a time.")
    parser.add_argument("-j", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    parser.add_argument("-k", default="", metavar="TEXT", help="only mutants whose module and line hold this")
    options = parser.parse_args()
    started = time.monotonic()
    pytest.main([*QUICK, str(WARM_UP)])
    if not sound("before"):
        return 1
    every = [mutant for target in TARGETS for mutant in mutants(target)]
    chosen = [mutant for mutant in every if options.k in f"{mutant.target} {mutant.code}"]
    alive = sorted(survivors(chosen, options.j), key=lambda mutant: (mutant.target, mutant.line))
    # A tree that changed meanwhile would let every test fail, and every mutant look noticed.
    if not sound("after"):
        return 1
    known = listed()
    surprises = [mutant for mutant in alive if mutant.key not in known]
    for mutant in surprises:
        say(f"survived: {mutant.target}.py:{mutant.line}: {mutant.change}: {mutant.code}")
    keys = {mutant.key for mutant in alive}
    tried = {mutant.key for mutant in chosen}
    stale = [key for key in known if key not in keys and (key in tried or not options.k)]
    for target, code, change in stale:
        say(f"listed, but did not survive: {target}.py: {change}: {code}")
    seconds = time.monotonic() - started
    expected = len(alive) - len(surprises)
    noticed = len(chosen) - len(alive)
    say(f"{len(chosen)} mutants in {seconds:.0f} s: {noticed} noticed, {expected} known survivors")
    return 1 if surprises or stale else 0


if __name__ == "__main__":
    sys.exit(main())
