"""Drive every cause of a stop in every way, and keep the worst: `python tools/measure_stops.py [-k TEXT]`.

It writes `outcomes.csv` and `encoders.csv` in `hil_tests/failures`, of which `make docs` makes tables; tests
drive each row again. `-k` measures only causes whose name has the text, `-k encoders` what a board does
without one.
"""

# ruff: noqa: INP001 - a script, not a package

import argparse
import os
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))

from emulators.campaign.spread import in_order
from hil_tests.failures import encoders
from hil_tests.failures.drive import CAUSES, KEPT, Outcome, cases, driven

ENCODERS = "encoders"


def worst(name: str) -> list[Outcome]:
    """Return the longest way of each robot straight ahead, and of RARS's base and lift, on each link."""
    found: dict[object, Outcome] = {}
    for case in sorted(cases(CAUSES[name]), key=lambda case: (case.line, case.motion.name)):
        outcome = driven(case).outcome
        if case.place not in found or outcome.way_mm > found[case.place].way_mm:
            found[case.place] = outcome
    return list(found.values())


def _measured(one: tuple[str, str, float]) -> encoders.Off:
    return encoders.measured(*one)


def main() -> None:
    """Measure, and write after each cause."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("-k", default="", metavar="TEXT", help="only causes whose name has this")
    words.add_argument("-j", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    given = words.parse_args()
    chosen = [name for name in CAUSES if given.k in name]
    if given.k in ENCODERS:
        encoders.KEPT.write(in_order(_measured, list(encoders.wanted()), given.j))
    for name, rows in zip(chosen, in_order(worst, chosen, given.j), strict=True):
        others = [row for row in KEPT.read() if row.cause in {*CAUSES} - {name}]
        KEPT.write(sorted((*others, *rows), key=lambda row: row.case.place))
        print(*rows, sep="\n")  # noqa: T201


if __name__ == "__main__":
    main()
