"""Drive a list of manoeuvres with RARS's governor and without it, on all cores, and count what tips over.

`python -m hil_tests.stability usual --first 0 --count 1000`; the lists are in lists.toml. The exit status is
1 where one tips with the governor, or too few without it: then the list shows nothing.
"""

# ruff: noqa: T201 - it prints its progress

import argparse
import os
import sys
from functools import partial

from emulators.campaign.spread import in_order
from hil_tests.stability.manoeuvres import LISTS
from hil_tests.stability.tipped import tipped

TOGETHER = 25
"""Manoeuvres that one process drives before it reports."""


def main() -> int:
    """Drive them; exit status 1 where the governor fails, or the list shows nothing."""
    words = argparse.ArgumentParser(prog="stability", description=__doc__)
    words.add_argument("list", choices=LISTS)
    words.add_argument("--first", type=int, default=0, help="the first seed")
    words.add_argument("--count", type=int, help="the whole list unless given")
    words.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    given = words.parse_args()
    chosen = LISTS[given.list]
    count = chosen.count if given.count is None else given.count
    seeds = range(given.first, given.first + count)
    parts = [seeds[place : place + TOGETHER] for place in range(0, count, TOGETHER)]
    governed: list[int] = []
    free: list[int] = []
    for number, found in enumerate(in_order(partial(tipped, hard=chosen.hard), parts, given.jobs), 1):
        governed += found[0]
        free += found[1]
        done = min(number * TOGETHER, count)
        print(f"{done} of {count}: {len(governed)} tip with the governor, {len(free)} without", flush=True)
    if governed:
        print(f"seeds that tip with the governor: {governed}")
    return int(bool(governed) or 1000 * len(free) < chosen.of_1000 * count)


if __name__ == "__main__":
    sys.exit(main())
