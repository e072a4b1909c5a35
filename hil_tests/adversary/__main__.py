"""`python -m hil_tests.adversary rars --hours 1`: look for what breaks a rule, as long as wanted.

What is found is shrunk and written as a mission file, which `firmware-bridge bench` drives.
"""

# ruff: noqa: T201 - it prints its progress

import argparse
import os
import sys
from collections.abc import Iterator
from functools import cache, partial
from itertools import count
from pathlib import Path
from typing import NamedTuple

import numpy as np

from emulators.bench.bench_setup import bench_setup_of
from emulators.campaign.spread import in_order
from firmware_bridge.robot import RobotFileError
from hil_tests.adversary.coverage import Coverage, Met
from hil_tests.adversary.draw import Draw
from hil_tests.adversary.failing import FaultProfile
from hil_tests.adversary.robots import line_of, options, read, robot_of
from hil_tests.adversary.search import Search, as_toml
from hil_tests.adversary.truth import invariants

TOGETHER = 8
"""Seeds for each process before the budget is looked at."""


class Searched(NamedTuple):
    """What one seed gave: what it met, and what was found, in one line and as a file."""

    seed: int
    seconds: float
    met: frozenset[Met]
    found: str = ""
    text: str = ""


@cache
def search_of(line: str, profiles: frozenset[str]) -> Search:
    """Return this process's search."""
    robot = robot_of(read(line))
    kinds = frozenset(map(FaultProfile, profiles))
    return Search(robot, bench_setup_of(robot), invariants(robot), kinds)


def searched(line: str, profiles: frozenset[str], seed: int) -> Searched:
    """Drive one random run and its branches."""
    search = search_of(line, profiles)
    search.coverage.met.clear()
    found, seconds = search.random_run(seed)
    met = frozenset(search.coverage.met)
    return Searched(seed, seconds, met, *(() if found is None else (str(found), as_toml(found, line))))


def results(line: str, profiles: frozenset[str], first: int, jobs: int) -> Iterator[Searched]:
    """Yield the seeds' results in their order, without end; as many are driven ahead as processes need."""
    for begin in count(first, TOGETHER * jobs):
        yield from in_order(partial(searched, line, profiles), range(begin, begin + TOGETHER * jobs), jobs)


def main() -> int:
    """Search; exit status 1 where something was found."""
    words = argparse.ArgumentParser(prog="adversary", description=__doc__)
    options(words)
    words.add_argument("--profiles", nargs="+", choices=[it.value for it in FaultProfile], default=["honest"])
    words.add_argument("--hours", type=float, default=1.0, help="simulated")
    words.add_argument("--seed", type=int, default=0, help="the first one")
    words.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    words.add_argument("--out", type=Path, default=Path("out/adversary"))
    reported = words.parse_args()
    try:
        robot = robot_of(reported)
    except RobotFileError as error:
        words.error(str(error))
    line, profiles = line_of(reported), frozenset(reported.profiles)
    coverage, driven, finds, last = Coverage(), 0.0, 0, reported.seed
    # The budget is counted in the seeds' order: what is reported does not depend on the processes.
    for one in results(line, profiles, reported.seed, reported.jobs):
        driven, last = driven + one.seconds, one.seed
        coverage.met.update(one.met)
        if one.found:
            finds += 1
            reported.out.mkdir(parents=True, exist_ok=True)
            path = reported.out / f"{line.replace(' --', '-').replace(' ', '-')}-{one.seed}.toml"
            path.write_text(one.text, encoding="utf-8")
            print(f"seed {one.seed}: {one.found}; {path}", flush=True)
        if driven >= 3600.0 * reported.hours:
            break
    setup = bench_setup_of(robot)
    drawn = Draw(robot, setup, np.random.default_rng(0), frozenset(map(FaultProfile, profiles))).kinds
    print(f"no fault was on in: {'; '.join(coverage.never) or 'no joint state left'}")
    seeds = f"seeds {reported.seed} to {last}"
    print(f"{driven / 3600.0:.2f} simulated hours, {seeds}, {coverage.share(drawn)}, {finds} found")
    return int(finds > 0)


if __name__ == "__main__":
    sys.exit(main())
