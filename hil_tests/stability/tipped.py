"""A part of a list of manoeuvres, driven in any process: which tip over with the governor, and without it."""

from collections.abc import Iterable
from functools import cache

from hil_tests.stability.manoeuvres import Driver, drawn, robot


@cache
def driver(*, governed: bool) -> Driver:
    """Return this process's driver."""
    return Driver(robot(governed=governed))


def tipped(seeds: Iterable[int], *, hard: bool) -> tuple[list[int], list[int]]:
    """Return the seeds of what tips with the governor, and without it."""
    manoeuvres = [drawn(seed, hard=hard) for seed in seeds]
    with_it, without = (
        [one.seed for one in manoeuvres if driver(governed=governed).tips(one)] for governed in (True, False)
    )
    return with_it, without
