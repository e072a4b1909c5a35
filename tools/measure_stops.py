"""Drive every cause of a stop in every way, and keep the worst: `python tools/measure_stops.py [-k TEXT]`.

It writes `measured.csv`, `boards.csv`, `every_robot.csv` and `encoders.csv` in `hil_tests/failures`, of which
`make docs` makes tables; tests drive each row again. `-k boards` measures the boards alone, `-k robots` every
robot in brief, `-k encoders` what a board does without one.
"""

# ruff: noqa: INP001 - a script, not a package

import argparse
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from hil_tests.failures import boards, encoders, every_robot
from hil_tests.failures.cases import CAUSES, Cause
from hil_tests.failures.drive import draws, driven
from hil_tests.failures.measured import KEPT, Worst

BOARDS = "boards"
ROBOTS = "robots"
ENCODERS = "encoders"


def worst(cause: Cause) -> list[Worst]:
    """Return the longest way of the base and of the lift on each link."""
    found: dict[tuple[str, bool], Worst] = {}
    for draw in draws(cause):
        row = Worst.of(cause, draw, driven(cause, draw).came)
        key = draw.link, draw.motion.lifts
        if key not in found or row.way_mm > found[key].way_mm:
            found[key] = row
    return list(found.values())


def run_on(protocol: str) -> list[boards.RunsOn]:
    """Return how far the base runs on with this firmware, cause by cause."""
    return [boards.seen(cause, protocol).row for cause in boards.CAUSES]


def on_line(line: str) -> list[every_robot.Row]:
    """Return what comes of each cause on one robot over one link."""
    pairs = [pair for robot in every_robot.LINES for pair in every_robot.wanted(robot)]
    return [every_robot.measured(*pair) for pair in pairs if pair[0] == line]


def main() -> None:
    """Measure, and write after each cause."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("-k", default="", metavar="TEXT", help="only causes whose name holds this")
    words.add_argument("-j", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    told = words.parse_args()
    chosen = [cause for cause in CAUSES if told.k in cause.name]
    with ProcessPoolExecutor(told.j) as pool:
        if told.k in BOARDS:
            found = [row for rows in pool.map(run_on, boards.FULL) for row in rows]
            names = [cause.name for cause in boards.CAUSES]
            boards.KEPT.write(sorted(found, key=lambda row: names.index(row.cause)))
        if told.k in ROBOTS:
            lines = [line for lines in every_robot.LINES.values() for line in lines]
            order = [pair for robot in every_robot.LINES for pair in every_robot.wanted(robot)]
            rows_of_all = [row for rows in pool.map(on_line, lines) for row in rows]
            every_robot.KEPT.write(sorted(rows_of_all, key=lambda row: order.index((row.line, row.cause))))
        if told.k in ENCODERS:
            encoders.KEPT.write(pool.map(encoders.measured, *zip(*encoders.wanted(), strict=True)))
        for cause, rows in zip(chosen, pool.map(worst, chosen), strict=True):
            names = {one.name for one in CAUSES} - {cause.name}
            others = [row for row in KEPT.read() if row.cause in names]
            KEPT.write(sorted((*others, *rows), key=lambda row: row.place))
            for row in rows:
                print(f"{row.cause}, {row.link}, {row.motion}: {row.way_mm} mm, {row.rest_ms} ms")  # noqa: T201


if __name__ == "__main__":
    main()
