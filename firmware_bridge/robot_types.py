"""The kinds of robots that are installed, found by entry point, and the robot files that they bring.

An entry in the group `firmware_bridge.robots` names a `firmware_bridge.robot_type.RobotType`, under its name.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache, lru_cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any, Final, Protocol

from firmware_bridge.drivers.all_drivers import reports_of
from firmware_bridge.drivers.driver import Position, Speed
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.robot.file import robot_of, schema, table_of, text_of
from firmware_bridge.robot.problems import near
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.safety.common import AXIS_INTERLOCKS
from firmware_bridge.safety.interlock import AxisInterlock
from firmware_bridge.safety.kinematic_model import KinematicModel
from firmware_bridge.teleop.station import Unusable, Velocity
from firmware_bridge.units import RPM_PER_RAD_S

GROUP: Final = "firmware_bridge.robots"
SIGN: Final = "+"
"""Between a kind and what its robot has more."""
PLANTS: Final = "firmware_bridge.plants"
"""The entry-point group of plants; the bridge uses it for names alone."""
SLOWEST_SHARE: Final = 0.01
"""Of the profile's velocity."""
SUM_ROUNDED: Final = 0.01
"""Relative tolerance for the rounding of a sum's factors."""
SUM_ABOVE: Final = 1.05
"""Ratio of a bound to the largest command up to which it counts as hardly above it."""
SUM_WIDEST: Final = 1.3
"""With the right factors a bound has room for what loops on a board overshoot; a wider one guards nothing."""
SUM_OFFERED: Final = 1.01
"""Above the limit, for rounding."""
ROUNDING: Final = 1e-9
"""Share of a bound by which a set-point may pass it: the last bits of its arithmetic."""


class _Named(Protocol):
    @property
    def name(self) -> str: ...


class InstalledPlant(Protocol):
    """The part of a plant that a robot file may name."""

    @property
    def parameters(self) -> Sequence[_Named]:
        """The parameters that can be set."""

    @property
    def sets(self) -> Mapping[str, object]:
        """Parameter sets by their names."""


@cache
def _entries() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name)}


def names() -> tuple[str, ...]:
    """Return the names of the installed kinds, in alphabetical order."""
    return tuple(_entries())


def robots() -> dict[str, Path]:
    """Return all robots that come with the installed kinds, by their names: the last file of each."""
    found: dict[str, Path] = {}
    for name in names():
        # One broken package must not hide the robots of the others.
        try:
            robot_type = robot_type_named(name)
        except RobotFileError:
            continue  # `unloadable` reports it; the others are there
        found |= {name: robot_type.file} | {
            name + SIGN + more: path for more, path in robot_type.more.items()
        }
    return found


def unloadable() -> dict[str, RobotFileError]:
    """Return why kinds that are installed cannot be loaded, by their names."""
    found: dict[str, RobotFileError] = {}
    for name in names():
        try:
            robot_type_named(name)
        except RobotFileError as error:
            found[name] = error
    return found


def readable() -> list[AnyRobot]:
    """Return each installed kind's own robot, where it can be read."""
    found = []
    for name in names():
        with suppress(RobotFileError):
            found.append(find(name))
    return found


@cache
def robot_type_named(name: str) -> AnyRobotType:
    """Return an installed kind; KeyError for a name that is not there, RobotFileError of a broken one."""
    entry = _entries()[name]
    try:
        robot_type: AnyRobotType = entry.load()
    except Exception as error:
        problem = f"cannot be loaded: {type(error).__name__}: {error} ({entry.value})"
        raise RobotFileError(name, Problem("", problem)) from error
    return robot_type


def robot_type_of(robot: AnyRobot) -> AnyRobotType:
    """Return a robot's kind, which is installed: its file could not have been read otherwise."""
    return robot_type_named(robot.kind)


def find(name: str, *, plant_too: bool = False) -> AnyRobot:
    """Read the robot of an installed kind, or one from a path that ends in .toml; RobotFileError.

    KIND+MORE is the kind's own robot with the tables of its further file MORE.
    """
    if name.endswith(".toml") or SIGN in name or name not in _entries():
        return parse(text_named(name), name, plant_too=plant_too)
    return load(robot_type_named(name).file, plant_too=plant_too)


def text_named(name: str) -> str:
    """Return the text of a robot file, named as for `find`; RobotFileError where there is none."""
    if name.endswith(".toml"):
        return text_of(Path(name))
    installed, plus, more = name.partition(SIGN)
    if installed not in _entries():
        here = (
            f"; for the folder '{installed}' here say pip install -e {installed}"
            if Path(installed).is_dir()
            else ""
        )
        problem = f"no such robot; {near(installed, names())} (a path to a .toml file works, too){here}"
        raise RobotFileError(name, Problem("", problem))
    found = robot_type_named(installed)
    if not plus:
        return text_of(found.file)
    if more not in found.more:
        raise RobotFileError(name, Problem("", f"{installed} has no '{more}'; {near(more, found.more)}"))
    # TOML forbids a table twice, so a further file can only add tables.
    return "\n".join(map(text_of, (found.file, found.more[more])))


def load(path: Path, *, plant_too: bool = False) -> AnyRobot:
    """Read a robot file; RobotFileError where it is missing, unreadable or wrong; see `parse`."""
    return parse(text_of(path), str(path), plant_too=plant_too)


@lru_cache(maxsize=64)
def parse(text: str, file: str, *, plant_too: bool = False) -> AnyRobot:
    """Read a robot from TOML text; `file` names it in a RobotFileError.

    With `plant_too` its plant must be installed, which a robot that is driven for real does not need.
    """
    table = table_of(text, file)
    name = table.get("kind")
    if not isinstance(name, str) or name not in _entries():
        raise RobotFileError(file, _no_kind(name, table))
    robot_type = robot_type_named(name)
    more = plant_problems(table) if plant_too else ()
    robot = robot_of(table, file, robot_type.geometry, robot_type.groups, more)
    # One after the other: a ratio that is upside down would make every bound look exceeded.
    excess = (
        tuple(odd_ratios(robot))
        or tuple(beyond_bounds(robot, robot_type))
        or tuple(loose_sums(robot, robot_type))
    )
    if excess:
        raise RobotFileError(file, *excess)
    return robot


def _no_kind(name: object, table: Mapping[str, object]) -> Problem:
    if name is None:
        return Problem("name", "is missing")
    alone = table.get("name") == name
    missing = "no kind is given, and " if alone else ""
    problem = (
        f"{missing}no kind of robot '{name}' is installed; {near(name, names())} "
        "(is its package installed? pip install -e FOLDER)"
    )
    return Problem("name" if alone else "kind", problem)


def plant_problems(table: Mapping[str, object]) -> Iterator[Problem]:
    """Yield where a robot's table names a plant, a parameter set or a parameter that is not installed."""
    named = table.get("plant")
    if not isinstance(named, dict) or not isinstance(named.get("fmu"), str):
        return
    plants = {entry.name: entry for entry in entry_points(group=PLANTS)}
    if named["fmu"] not in plants:
        yield Problem("plant.fmu", f"no plant '{named['fmu']}' is installed; {near(named['fmu'], plants)}")
        return
    plant: InstalledPlant = plants[named["fmu"]].load()
    chosen, known = named.get("parameter_set"), [parameter.name for parameter in plant.parameters]
    if isinstance(chosen, str) and chosen not in plant.sets:
        problem = f"the plant has no parameter set '{chosen}'; {near(chosen, plant.sets)}"
        yield Problem("plant.parameter_set", problem)
    own = named.get("parameters")
    for name in own if isinstance(own, dict) else ():
        if name not in known:
            problem = f"the plant has no parameter '{name}'; {near(name, known)}"
            yield Problem(f"plant.parameters.{name}", problem)


def schema_of(name: str) -> dict[str, object]:
    """Return the JSON schema of a kind's robot files, for editors; RobotFileError where there is none."""
    if name not in _entries():
        raise RobotFileError(name, Problem("", f"no such kind of robot; {near(name, names())}"))
    return schema(robot_type_named(name).geometry)


def weaker_rows(robot: AnyRobot) -> Iterator[tuple[str, AxisInterlock, AxisInterlock]]:
    """Yield each axis whose driver lacks an interlock's reports, that interlock, and its replacement."""
    for axis in robot.axes:
        for row in AXIS_INTERLOCKS:
            fitting = row.fitting(reports_of(robot, axis))
            if fitting is not None and fitting is not row:
                yield axis.name, row, fitting


def beyond_bounds(robot: AnyRobot, robot_type: AnyRobotType) -> Iterator[Problem]:
    """Yield where the type's kinematics could command more than the guard's bounds in the file allow.

    The guard would refuse such a set-point, and put a stop in its place: better reported before anything
    moves.
    """
    try:
        most = _most_requested(robot, robot_type)
    except (ArithmeticError, ValueError) as error:
        yield Problem("geometry", f"the kinematics cannot be worked out with it: {error}")
        return
    for index, axis in enumerate(robot.axes):
        low, high = axis.travel or (-math.inf, math.inf)
        for what, bound, field, sign in (
            ("speed", axis.top_speed, "top_speed", 1.0),
            ("low", -low, "travel", -1.0),
            ("high", high, "travel", 1.0),
        ):
            requested = most.get((axis.name, what))
            # Written so that NaN is reported, too.
            if requested is not None and not requested <= bound + ROUNDING * abs(bound):
                unit = axis.unit.value + ("/s" if what == "speed" else "")
                yield Problem(
                    f"axes[{index}].{field}",
                    f"the robot's limits let '{axis.name}' be commanded to {sign * requested:.5g} {unit}, "
                    f"the bound is {sign * bound:.5g} {unit}; widen it, or narrow the limits",
                )


def odd_ratios(robot: AnyRobot) -> Iterator[Problem]:
    """Yield where an axis's top speed hardly turns its motor: a gear's ratio that is upside down."""
    for index, axis in enumerate(robot.axes):
        turns, profile = axis.top_speed * axis.ratio * RPM_PER_RAD_S, axis.settings.profile_rpm()
        if turns < SLOWEST_SHARE * profile:
            yield Problem(
                f"axes[{index}].ratio",
                f"with {axis.ratio:g} top_speed turns the motor with {turns:.3g} rpm, its profile is "
                f"made for {profile:.10g}; it is the motor's turns for one of the axis",
            )


def loose_sums(robot: AnyRobot, robot_type: AnyRobotType) -> Iterator[Problem]:
    """Yield where a sum of the guard is not what geometry and limits give: its factors are of another robot.

    The sum is worked out where the kinematics ask for most. With the right factors that is the limit of speed
    or of turning itself; a sum of something else is taken as it is where its bound is hardly above it.
    """
    for index, total in enumerate(robot.guard.sums):
        most = max(
            [_summed(robot_type.kinematics(robot), total.of, *pair) for pair in robot_type.reach(robot)],
            default=0.0,
        )
        limit = _limit_of(robot, robot_type, total.of, most)
        if most <= 0.0 or limit is None:
            continue
        right = limit / most
        fits = abs(right - 1.0) <= SUM_ROUNDED
        if (
            most <= total.bound * (1.0 + ROUNDING)
            and total.bound <= (SUM_WIDEST if fits else SUM_ABOVE) * most
        ):
            continue
        factors = ", ".join(f"{name} = {factor * right:.4g}" for name, factor in total.of.items())
        say = f"bound = {SUM_OFFERED * limit:.4g}" if fits else f"of = {{{factors}}}"
        yield Problem(
            f"guard.sums[{index}]",
            f"with this geometry '{total.name}' reaches its bound of {total.bound:g} at "
            f"{total.bound * right:.3g}, the robot's limit is {limit:.4g}; use {say}",
        )


def _limit_of(
    robot: AnyRobot, robot_type: AnyRobotType, of: Mapping[str, float], most: float
) -> float | None:
    """Return which of the robot's limits a sum is of: that at which it is largest, else the nearest."""
    largest, body = robot_type.station.largest(robot), robot_type.kinematics(robot)
    pure = {
        Velocity(largest.forward_mps, 0.0, 0.0): largest.forward_mps,
        Velocity(0.0, largest.left_mps, 0.0): largest.left_mps,
        Velocity(0.0, 0.0, largest.yaw_rate_rad_s): largest.yaw_rate_rad_s,
    }
    states = [state for _, state in robot_type.reach(robot)]
    for velocity, limit in pure.items():
        motion = robot_type.station.target(velocity, robot_type.standstill, robot)
        if limit == 0.0 or isinstance(motion, Unusable):
            continue
        # Whatever the state: a base that is steered turns as it drives.
        if min(_summed(body, of, motion, state) for state in states) >= (1.0 - SUM_ROUNDED) * most:
            return limit
    # In the logarithm: twice and half a limit are equally far from it.
    return min(
        (it for it in pure.values() if it > 0.0), key=lambda it: abs(math.log(it / most)), default=None
    )


def _summed(body: KinematicModel[Any, Any], of: Mapping[str, float], motion: object, state: object) -> float:
    """Return a sum of axis speeds for a motion; 0 where they are not commanded together."""
    set_points = body.set_points(motion, state)
    speeds = {name: set_point.value for name, set_point in set_points.items() if isinstance(set_point, Speed)}
    return (
        abs(sum(factor * speeds[name] for name, factor in of.items())) if speeds.keys() >= of.keys() else 0.0
    )


def _most_requested(robot: AnyRobot, robot_type: AnyRobotType) -> dict[tuple[str, str], float]:
    """Return the largest command of each axis: speed, and position to either side; NaN stays NaN."""
    body = robot_type.kinematics(robot)
    most: dict[tuple[str, str], float] = {}
    for motion, state in robot_type.reach(robot):
        for name, set_point in body.set_points(motion, state).items():
            requested: Iterable[tuple[str, float]] = ()
            if isinstance(set_point, Speed):
                requested = (("speed", abs(set_point.value)),)
            elif isinstance(set_point, Position):
                requested = (("low", -set_point.value), ("high", set_point.value))
            for what, value in requested:
                # Written so that NaN takes the place of any number, and stays.
                if not value <= most.get((name, what), -math.inf):
                    most[name, what] = value
    return most
