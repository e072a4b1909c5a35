"""Consistency of a robot file's tables on CiA 402 drives: nodes, times, homing, what measures the supply."""

from collections.abc import Iterator
from typing import Final

from firmware_bridge.canopen_drive import check as drives
from firmware_bridge.families.cia402.settings import Cia402Driver
from firmware_bridge.robot import Problem, raw
from firmware_bridge.robot.raw import Raw
from firmware_bridge.robot.zero import METHODS

STANDARD: Final = tuple(method for method in METHODS if method > 0)
"""Homing methods of CiA 402 that a robot file may name; below 0 they are a maker's own."""


def check(table: Raw) -> Iterator[Problem]:
    """Yield the inconsistencies of a robot's drives."""
    links = raw.links_of(table, Cia402Driver)
    own = {index: axis for index, axis in enumerate(raw.rows(table, "axes")) if axis.get("link") in links}
    yield from drives.check(table, links)
    for index, axis in own.items():
        homing = raw.within(raw.within(axis, "zero"), "homing")
        method, offset = homing.get("method"), homing.get("offset")
        if isinstance(method, int) and method not in STANDARD:
            known = ", ".join(map(str, STANDARD[:-1]))
            problem = f"{method} is a method of maxon's EPOS; of CiA 402 there are {known} and {STANDARD[-1]}"
            yield Problem(f"axes[{index}].zero.homing.method", problem)
        if isinstance(offset, int | float) and offset:
            problem = f"{offset:g}: a CiA 402 drive stays where it has found its reference; leave it out"
            yield Problem(f"axes[{index}].zero.homing.offset", problem)
