"""The kinds of robots that are installed, found by entry point, and the robot files that they bring.

An entry in the group `firmware_bridge.robots` names a `firmware_bridge.kind.Kind`; its name is the kind's.
"""

import math
from collections.abc import Iterator
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Final

from firmware_bridge.drivers.driver import Position, Speed
from firmware_bridge.drivers.fleets import TELLS
from firmware_bridge.kind import AnyKind
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.robot.file import robot_of, schema, table_of, text_of
from firmware_bridge.robot.problems import near
from firmware_bridge.safety.common import AXIS_ROWS
from firmware_bridge.safety.interlock import AxisInterlock

GROUP: Final = "firmware_bridge.robots"
ROUNDING: Final = 1e-9
"""Share of a bound by which a demand may pass it: the last bits of its arithmetic."""


@cache
def _entries() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name)}


def names() -> tuple[str, ...]:
    """Return the names of the installed kinds, in alphabetical order."""
    return tuple(_entries())


@cache
def kind_named(name: str) -> AnyKind:
    """Return an installed kind; KeyError where there is none of this name."""
    kind: AnyKind = _entries()[name].load()
    return kind


def kind_of(robot: AnyRobot) -> AnyKind:
    """Return a robot's kind, which is installed: its file could not have been read otherwise."""
    return kind_named(robot.kind)


def find(name: str) -> AnyRobot:
    """Read the robot of an installed kind, or one from a path that ends in .toml; RobotFileError."""
    if name.endswith(".toml"):
        return load(Path(name))
    if name not in _entries():
        problem = f"no such robot; {near(name, names())}. A path to a .toml file works, too"
        raise RobotFileError(name, Problem("", problem))
    return load(kind_named(name).file)


def load(path: Path) -> AnyRobot:
    """Read a robot file; RobotFileError where it is missing, unreadable or wrong."""
    return parse(text_of(path), str(path))


def parse(text: str, file: str) -> AnyRobot:
    """Read a robot from TOML text; `file` names it in a RobotFileError."""
    table = table_of(text, file)
    name = table.get("kind")
    if name not in _entries():
        key = "kind" if "kind" in table else "name"
        problem = f"no kind of robot '{name}' is installed; {near(name, names())}" if name else "is missing"
        raise RobotFileError(file, Problem(key, problem))
    kind = kind_named(str(name))
    robot = robot_of(table, file, kind.geometry, kind.groups)
    excess = tuple(beyond_bounds(robot, kind))
    if excess:
        raise RobotFileError(file, *excess)
    return robot


def schema_of(name: str) -> dict[str, object]:
    """Return the JSON schema of a kind's robot files; RobotFileError where there is no such kind."""
    if name not in _entries():
        raise RobotFileError(name, Problem("", f"no such kind of robot; {near(name, names())}"))
    return schema(kind_named(name).geometry)


def weaker_rows(robot: AnyRobot) -> Iterator[tuple[str, AxisInterlock, AxisInterlock]]:
    """Yield each axis whose driver tells too little for a common row, that row, and what stands in for it."""
    for axis in robot.axes:
        for row in AXIS_ROWS:
            fitting = row.fitting(TELLS[robot.links[axis.link].driver])
            if fitting is not None and fitting is not row:
                yield axis.name, row, fitting


def beyond_bounds(robot: AnyRobot, kind: AnyKind) -> Iterator[Problem]:
    """Yield where the kind's kinematics could ask for more than the guard's bounds in the file allow.

    The guard would refuse such a set-point, and put a stop in its place: better said before anything moves.
    """
    most = _most_asked(robot, kind)
    for index, axis in enumerate(robot.axes):
        low, high = axis.travel or (-math.inf, math.inf)
        for what, bound, field, sign in (
            ("speed", axis.top_speed, "top_speed", 1.0),
            ("low", -low, "travel", -1.0),
            ("high", high, "travel", 1.0),
        ):
            asked = most.get((axis.name, what))
            if asked is not None and asked > bound + ROUNDING * abs(bound):
                unit = axis.unit.value + ("/s" if what == "speed" else "")
                yield Problem(
                    f"axes[{index}].{field}",
                    f"the robot's limits let '{axis.name}' be asked for {sign * asked:.5g} {unit}, "
                    f"the bound is {sign * bound:.5g} {unit}; widen it, or narrow the limits",
                )


def _most_asked(robot: AnyRobot, kind: AnyKind) -> dict[tuple[str, str], float]:
    """Return the fastest, lowest (its negative) and highest that each axis may be asked for."""
    body = kind.body(robot)
    most: dict[tuple[str, str], float] = {}
    for motion, state in kind.reach(robot):
        for name, demand in body.demands(motion, state).items():
            asked: tuple[tuple[str, float], ...] = ()
            if isinstance(demand, Speed):
                asked = (("speed", abs(demand.value)),)
            elif isinstance(demand, Position):
                asked = (("low", -demand.value), ("high", demand.value))
            for what, value in asked:
                most[name, what] = max(most.get((name, what), -math.inf), value)
    return most
