# ruff: noqa: INP001 - a script, not a package
"""Mutation campaign: break the safety code in one place at a time; its tests must notice every time.

Run it as `python tools/mutate_safety.py [-j N] [-k TEXT]`. It exits with 1 when a mutant survives that is not
in `tools/mutate_survivors.toml`, when that list names one that does not, or when a safety module is left out.
Only the fast tests of the mutated module run, and the first failure ends the run.
"""

import argparse
import os
import sys
import time
import tomllib
from collections.abc import Iterator
from typing import Final

from campaign import Unsound, tried
from mutants import ROOT, mutants

SURVIVORS: Final = ROOT / "tools" / "mutate_survivors.toml"
GATE_TESTS: Final = (
    "safety/test_gate_lift.py",
    "safety/test_gate_limits.py",
    "safety/test_gate_stops.py",
    "safety/test_what_follows.py",
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
ZERO_TESTS: Final = ("safety/test_guard_zero.py",)
EVERY_ROBOTS_TESTS: Final = tuple(
    f"robots/test_every_robot.py::test_{what}"
    for what in (
        "at_its_threshold_a_row_holds_and_says_why",
        "just_within_its_threshold_a_row_does_not_hold",
        "a_row_lets_go_when_it_was_clear_for_its_clear_time",
        "a_stop_brings_every_axis_to_rest",
    )
)
TARGETS: Final = {
    "motion/ramp": ("unit/motion/test_ramp.py",),
    "safety/charge": ("unit/pipeline/test_charge.py",),
    "safety/common": (*GATE_TESTS, "safety/test_weaker_rows.py"),
    "safety/gate": (*GATE_TESTS, "safety/test_weaker_rows.py"),
    "safety/interlock": (*GATE_TESTS, "safety/test_weaker_rows.py"),
    "safety/following": ("safety/test_following.py", "unit/pipeline/test_disbelieved.py"),
    "safety/limits": GATE_TESTS,
    "safety/row": ("safety/test_what_follows.py",),
    "safety/rules": ("safety/test_what_follows.py", "unit/pipeline/test_rest.py"),
    "safety/snapshot": (
        "safety/test_gate_limits.py",
        "safety/test_following.py",
        "safety/test_what_follows.py",
    ),
    "robots/rars/rules": GATE_TESTS,
    "carrier/rules": ("robots/test_carrier_rules.py", *EVERY_ROBOTS_TESTS),
    "safety/guard/guard": GUARD_TESTS + GUARD_SERIAL_TESTS + ACROSS_TESTS,
    "safety/guard/across_axes": ACROSS_TESTS,
    "safety/guard/axis": GUARD_TESTS + ACROSS_TESTS + ZERO_TESTS,
    "safety/guard/bounds": ("safety/test_guard_bounds.py",),
    "safety/guard/epos2_can": GUARD_TESTS + ACROSS_TESTS + ZERO_TESTS,
    "safety/guard/epos2_serial": (
        *GUARD_SERIAL_TESTS,
        "safety/test_guard_reports.py",
        *ACROSS_TESTS,
        *ZERO_TESTS,
    ),
    "safety/guard/epos2_words": GUARD_TESTS[::-1] + ZERO_TESTS,
    "safety/guard/zeroing": ZERO_TESTS,
    "safety/guard/writes": GUARD_TESTS[::-1] + GUARD_SERIAL_TESTS,
}
"""Modules of `firmware_bridge` or an example, and the tests of `hil_tests` that must kill their mutants."""


def left_out() -> Iterator[str]:
    """Yield the safety modules, and the robots' rules, that could be broken and are no targets."""
    ours = ROOT / "firmware_bridge"
    names = [
        file.relative_to(ours) for file in (*ours.glob("safety/**/*.py"), *ours.glob("robots/*/rules.py"))
    ]
    names += [file.relative_to(file.parents[1]) for file in ROOT.glob("examples/*/*/rules.py")]
    for name in sorted(str(name.with_suffix("")) for name in names):
        if name not in TARGETS and next(mutants(name), None) is not None:
            yield name


def listed() -> dict[tuple[str, str, str], str]:
    """Return the known survivors and why nothing can notice them."""
    rows = tomllib.loads(SURVIVORS.read_text(encoding="utf-8")).get("survivor", [])
    return {(row["module"], row["code"], row["change"]): row["reason"] for row in rows}


def say(text: str) -> None:
    """Tell the user at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def main() -> int:
    """Run the campaign and say what came of it."""
    parser = argparse.ArgumentParser(description="Break the safety code in one place at a time.")
    parser.add_argument("-j", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    parser.add_argument("-k", default="", metavar="TEXT", help="only mutants whose module and line hold this")
    options = parser.parse_args()
    started = time.monotonic()
    complaints = [f"a safety module that is left out: {name}" for name in left_out()]
    every = [mutant for target in TARGETS for mutant in mutants(target)]
    chosen = [mutant for mutant in every if options.k in f"{mutant.target} {mutant.code}"]
    alive = []
    for target, tests in TARGETS.items():
        mine = [mutant for mutant in chosen if mutant.target == target]
        if mine:
            begun = time.monotonic()
            try:
                alive += tried(target, tests, mine, options.j)
            except Unsound as problem:
                say(f"{target}: {problem}")
                return 1
            say(f"{target}: {len(mine)} mutants, {time.monotonic() - begun:.0f} s")
    known = listed()
    surprises = [mutant for mutant in alive if mutant.key not in known]
    complaints += [f"survived: {one.target}.py:{one.line}: {one.change}: {one.code}" for one in surprises]
    keys = {mutant.key for mutant in alive}
    run = {mutant.key for mutant in chosen}
    stale = [key for key in known if key not in keys and (key in run or not options.k)]
    complaints += [f"listed, but did not survive: {key[0]}.py: {key[2]}: {key[1]}" for key in stale]
    for complaint in complaints:
        say(complaint)
    expected = len(alive) - len(surprises)
    noticed = len(chosen) - len(alive)
    seconds = time.monotonic() - started
    say(f"{len(chosen)} mutants in {seconds:.0f} s: {noticed} noticed, {expected} known survivors")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
