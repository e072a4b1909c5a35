"""Bridge, bench and plants know no robot: nothing outside their folders looks something up by a robot's name.

Checked are identifiers and imports, which may be no role of an axis and no mode, and strings that serve as
keys, which may be no name of a robot, an axis, a role, a group or a mode. The product's robots and those of
the examples without a device family of their own count, whichever of them are installed.
"""

import ast
import tomllib
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Final

import pytest

from firmware_bridge import robot_types
from firmware_bridge.family import GROUP as FAMILIES
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.file import robot_of, table_of, text_of
from firmware_bridge.robot_type import AnyRobotType

ROOT: Final = Path(__file__).parents[2]
PACKAGES: Final = ("firmware_bridge", "emulators", "fmu")
THEIR_OWN: Final = (
    "firmware_bridge/robots/",
    "firmware_bridge/motion/",
    "firmware_bridge/differential/",
    "emulators/robots/",
    "emulators/epos2/starter/",
    "fmu/ar2/",
    "fmu/parts/",
    "fmu/climber/",
    "fmu/rars/",
    "fmu/rars_tipping/",
    "fmu/rome_arm/",
    "fmu/rome_base/",
    "fmu/single_axis/",
)
"""Robots and single plants, kinematics and parts that they share, and what writes a robot with two wheels."""


def of_this_tree() -> Iterator[tuple[AnyRobotType, AnyRobot]]:
    """Yield the robots whose entry points stand in the tree: who has installed what must not matter."""
    for project in (ROOT / "pyproject.toml", *sorted(ROOT.glob("examples/*/pyproject.toml"))):
        groups = tomllib.loads(project.read_text(encoding="utf-8"))["project"]["entry-points"]
        # The file of a robot with devices of its own is read only where their family is installed.
        if project.parent != ROOT and FAMILIES in groups:
            continue
        for name, value in groups.get(robot_types.GROUP, {}).items():
            kind: AnyRobotType = EntryPoint(name, value, robot_types.GROUP).load()
            file = str(kind.file)
            yield kind, robot_of(table_of(text_of(kind.file), file), file, kind.geometry, kind.groups)


ROBOTS: Final = tuple(of_this_tree())
SHIPPED: Final = frozenset(kind.name for kind, _ in ROBOTS)
GENERAL: Final = frozenset({"axis"})
"""What a robot of one axis calls it, as everything does."""
ROLES: Final = frozenset(axis.role for _, robot in ROBOTS for axis in robot.axes) - GENERAL
MODES: Final = frozenset(mode for kind, _ in ROBOTS for mode in kind.modes)
KEYS: Final = (
    ROLES
    | MODES
    | SHIPPED
    | frozenset(axis.name for _, robot in ROBOTS for axis in robot.axes)
    | frozenset(group for kind, _ in ROBOTS for group in kind.groups)
) - GENERAL
LOOKS_UP: Final = {"axis", "get", "pop", "setdefault", "startswith", "find"}
"""Methods whose first argument is a key."""


def identifiers(node: ast.AST) -> Iterator[str]:
    """Yield the words of an identifier, and those of an import."""
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name):
            yield name
        case ast.keyword(arg=str(name)) | ast.FunctionDef(name=name) | ast.ClassDef(name=name):
            yield name
        case ast.alias(name=name, asname=other):
            yield from (*name.split("."), other or "")
        case ast.ImportFrom(module=str(module)):
            yield from module.split(".")


def keys(node: ast.AST) -> Iterator[str]:
    """Yield the strings by which something is looked up."""
    found: list[ast.expr | None] = []
    match node:
        case ast.Subscript(slice=key):
            found = [key]
        case ast.Dict(keys=all_of_them):
            found = all_of_them
        case ast.Set(elts=elements):
            found = list(elements)
        case ast.Compare(left=left, comparators=others):
            found = [left, *others]
        case ast.Call(func=ast.Attribute(attr=method), args=[first, *_]) if method in LOOKS_UP:
            found = [first]
        case ast.MatchValue(value=value):
            found = [value]
    inner = [it for one in found for it in (one.elts if isinstance(one, ast.Tuple | ast.Set) else [one])]
    yield from (one.value for one in inner if isinstance(one, ast.Constant) and isinstance(one.value, str))


def found_in(path: str, source: str) -> list[str]:
    """Return the robots' names in a program, each with its place."""
    found = []
    for node in ast.walk(ast.parse(source)):
        named = set(identifiers(node)) & (ROLES | MODES)
        looked_up = {key for key in keys(node) if key in KEYS}
        found += [f"{path}:{getattr(node, 'lineno', 0)}: {word!r}" for word in sorted(named | looked_up)]
    return found


def test_the_names_are_those_of_the_robots_of_this_tree() -> None:
    assert {"ar2", "rars", "diff_drive", "climber", "rome", "rome_arm", "servo_axis"} == SHIPPED
    assert {"steering", "lift", "left_wheel", "wheel_one"} <= ROLES
    assert {"steering_failed", "left_failed"} <= MODES
    assert {"left", "base", "chassis", "steer", "one"} <= KEYS


def test_nothing_outside_the_robots_folders_names_one() -> None:
    files = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
    names = [path.relative_to(ROOT).as_posix() for path in files]
    assert len(names) > 200
    rest = [name for name in names if not name.startswith(THEIR_OWN)]
    assert [each for name in rest for each in found_in(name, (ROOT / name).read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize(
    "planted",
    [
        "lift = 3",
        "def steering(angle): pass",
        "go(steering=0.1)",
        "from firmware_bridge.things import steering",
        "from firmware_bridge.robots.lift import go",
        "motion.lift = True",
        "robot.axis('left')",
        "groups = {'base'}",
        "axes['left'].speed",
        "bounds = {'steer': 1.0}",
        "if robot.kind == 'rars': pass",
        "if mode in ('steering_failed', ''): pass",
        "match kind:\n    case 'climber': pass",
    ],
)
def test_a_planted_name_is_found(planted: str) -> None:
    assert found_in("firmware_bridge/bridge/planted.py", planted)


@pytest.mark.parametrize(
    "innocent",
    [
        "attempts_left = 3",
        "left, right = 1, 2",
        "text = 'two are left, turn right'",
        "help('`firmware-bridge drive rars` drives it')",
        "axis.set_title('speed', loc='left')",
        "one.lifted = uplifting",
    ],
)
def test_other_words_are_free(innocent: str) -> None:
    assert found_in("firmware_bridge/bridge/planted.py", innocent) == []
