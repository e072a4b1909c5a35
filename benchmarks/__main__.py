"""All figures of speed and size in one table.

Usage: python -m benchmarks [PART ...] [--keep RELEASE]

Exit status 0; 1 where a goal is missed; 2 where other processes kept the machine busy: it is INVALID then.
"""

import argparse
import importlib
import sys
import time
from typing import Final

from benchmarks.figure import MOST_OTHERS, Figure, OthersLoad, keep, table

PARTS: Final = (
    *("parts", "scale", "device", "boards", "against_fmpy", "moments"),
    *("mcap_cost", "monitor_live", "live_page", "start", "memory"),
)
"""The modules with a function `figures`."""


def main() -> int:
    """Measure, print, and keep where that is wanted."""
    words = argparse.ArgumentParser(prog="benchmarks", description=__doc__)
    words.add_argument("part", nargs="*", metavar="PART", help=f"one of {', '.join(PARTS)}; all by default")
    words.add_argument("--keep", metavar="RELEASE", help="write the ratios into the history of releases")
    given = words.parse_args()
    unknown = [name for name in given.part if name not in PARTS]
    if unknown:
        words.error(f"no such part: {', '.join(unknown)}; there are {', '.join(PARTS)}")
    load, found, begun = OthersLoad(), list[Figure](), time.perf_counter()
    for name in given.part or PARTS:
        at = time.perf_counter()
        found += importlib.import_module(f"benchmarks.{name}").figures()
        print(f"{name}: {time.perf_counter() - at:.0f} s", file=sys.stderr)
    others = load.seen()
    valid = others <= MOST_OTHERS
    state = "" if valid else f"INVALID: above {MOST_OTHERS:g} no figure counts; "
    taken = time.perf_counter() - begun
    note = f"{state}other processes kept {others:.2f} processors busy; measured in {taken:.0f} s"
    table(found, "figures" if valid else "figures, INVALID", note)
    if not valid:
        return 2
    if given.keep:
        keep(found, given.keep)
    return 0 if all(one.met for one in found) else 1


if __name__ == "__main__":
    sys.exit(main())
