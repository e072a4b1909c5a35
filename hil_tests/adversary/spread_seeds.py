"""The search spread over processes: seeds in their order, whatever drives them."""

from collections.abc import Iterator
from functools import cache, partial
from itertools import count
from typing import NamedTuple

from emulators.bench.bench_setup import bench_setup_of
from emulators.campaign.spread import in_order
from hil_tests.adversary.coverage import Met
from hil_tests.adversary.failing import FaultProfile
from hil_tests.adversary.robots import read, robot_of
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
