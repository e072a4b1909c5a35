"""Run `fmea` on shipped robots, and keep its result by interlock: `python tools/measure_fmea.py [ROBOT ...]`.

It writes `hil_tests/hazards/analyzed.csv`, of which `make docs` makes a column of the safety pages; tests
drive the worst cell of each row again.
"""

# ruff: noqa: INP001 - a script, not a package

import argparse
import os
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

from hil_tests.failures.causes import LINES
from hil_tests.hazards.analysis import KEPT, analyzed


def main() -> None:
    """Measure, and write after each robot."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("robots", nargs="*", default=sorted(LINES), metavar="ROBOT")
    words.add_argument("-j", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    given = words.parse_args()
    for name in given.robots:
        rows = analyzed(name, given.j)
        others = [row for row in KEPT.read() if row.robot != name]
        KEPT.write(sorted((*others, *rows), key=lambda row: (row.robot, row.noticed_by, row.kind)))
        print(*rows, sep="\n")  # noqa: T201


if __name__ == "__main__":
    main()
