# ruff: noqa: INP001 - a script, not a package
"""Run the stories in real time on a machine that is busy, and count what they show.

`python tools/under_load.py [--runs 300] [--load 6] [TEST ...]` runs them again and again beside programs that
compute without end. A story that fails there must be INVALID, since the machine was late, or fail on the
quiet machine, too; else the exit status is 1. So it is where more than 30 % are INVALID: they show nothing.
"""

import argparse
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

ROOT: Final = Path(__file__).resolve().parent.parent
STORIES: Final = (
    "hil_tests/testing/test_control.py",
    "hil_tests/testing/test_process.py",
    "hil_tests/processes/test_control_on_a_bus.py",
    "hil_tests/processes/test_bench_in_real_time.py",
)
LATE_AFTER_S: Final = 0.1
MOST_INVALID: Final = 0.3
BUSY: Final = (sys.executable, "-c", "while True: pass")
NO_BUS: Final = "not vcan"


@contextmanager
def load(count: int) -> Iterator[None]:
    """Keep so many programs computing."""
    programs = [subprocess.Popen(BUSY) for _ in range(count)]  # noqa: S603 - it is named above
    try:
        yield
    finally:
        for program in programs:
            program.kill()
            program.wait()


def results(tests: Sequence[str], late_after_s: float) -> list[tuple[str, str]]:
    """Run tests once; return each one's id, and `passed`, `invalid`, `skipped` or `failed`."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        words = [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "no:xdist",
            "-p",
            "no:cacheprovider",
            "-m",
            NO_BUS,
        ]
        options = (f"--late-after={late_after_s}", f"--junitxml={report}", "-o", "junit_family=xunit1")
        subprocess.run([*words, *options, *tests], cwd=ROOT, stdout=subprocess.DEVNULL, check=False)  # noqa: S603
        cases = ET.parse(report).getroot().iter("testcase")  # noqa: S314 - pytest has just written it
        return [(f"{case.get('file')}::{case.get('name')}", _outcome(case)) for case in cases]


def _outcome(case: "ET.Element[str]") -> str:
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    skipped = case.find("skipped")
    if skipped is None:
        return "passed"
    return "invalid" if "INVALID" in (skipped.get("message") or "") + (skipped.text or "") else "skipped"


def main() -> int:
    """Run, and report in one line; return the exit status."""
    parser = argparse.ArgumentParser(description="Run the stories in real time on a busy machine.")
    parser.add_argument("tests", nargs="*", default=STORIES, metavar="TEST")
    parser.add_argument("--runs", type=int, default=300, metavar="N", help="at least so many runs of a story")
    parser.add_argument("--load", type=int, default=6, metavar="N", help="programs that compute beside them")
    options = parser.parse_args()
    counted: Counter[str] = Counter()
    failed: set[str] = set()
    while sum(counted.values()) < options.runs:
        with load(options.load):
            found = [one for one in results(options.tests, LATE_AFTER_S) if one[1] != "skipped"]
        if not found:
            sys.stdout.write("under load: no story ran\n")
            return 1
        counted.update(outcome for _, outcome in found)
        failed.update(name for name, outcome in found if outcome == "failed")
        shown = ", ".join(f"{number} {outcome}" for outcome, number in sorted(counted.items()))
        sys.stdout.write(f"under load: {sum(counted.values())} of {options.runs} runs: {shown}\n")
        sys.stdout.flush()
    quiet = (
        {name for name, outcome in results(sorted(failed), 0.0) if outcome == "failed"} if failed else set()
    )
    only_here = sorted(failed - quiet)
    for name in only_here:
        sys.stdout.write(f"under load: failed, and is good on a quiet machine: {name}\n")
    runs = sum(counted.values())
    share = counted["invalid"] / runs
    sys.stdout.write(
        f"under load {options.load}: {runs} runs, {counted['passed']} passed, {counted['failed']} failed "
        f"({len(only_here)} stories only there), {counted['invalid']} INVALID ({share:.0%}, "
        f"goal {MOST_INVALID:.0%})\n"
    )
    return 1 if only_here or share > MOST_INVALID else 0


if __name__ == "__main__":
    sys.exit(main())
