"""Bridge and bench know no family of devices: nothing outside its folders names it, or looks up by it.

Checked are identifiers, imports and strings that serve as keys, in the same way as for robots' names.
"""

import ast
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

from firmware_bridge.family import families
from hil_tests.architecture.test_no_robots_name import identifiers, keys

ROOT: Final = Path(__file__).parents[2]
PACKAGES: Final = ("firmware_bridge", "emulators", "fmu")
ENTRY_POINTS: Final = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
    "entry-points"
]
THEIR_OWN: Final = (
    "firmware_bridge/families/",
    *sorted(
        {
            f"{entry.partition(':')[0].rpartition('.')[0].replace('.', '/')}/"
            for entry in ENTRY_POINTS["firmware_bridge.emulated_families"].values()
        }
    ),
    "firmware_bridge/robots/",
    "emulators/robots/",
    "fmu/ar2/",
    "fmu/rome_arm/",
)
"""Families' folders on both sides, and robots' packages, which are made of particular devices."""
STANDARDS: Final = frozenset({"cia402", "firmware_bridge.canopen.cia402"})
"""The module of a standard, by which a family may be called, too."""
MAKERS: Final = frozenset({"maxon", "natnet", "shield", "firmata", "arduinoio"})
"""Other words for a family's devices and protocols."""
NAMES: Final = frozenset(family.name for family in families()) | MAKERS


def words(name: str) -> set[str]:
    """Return the words of an identifier, in small letters: those between underlines, and those of a class."""
    parts = re.findall(r"[A-Z]+(?![a-z])\d*|[A-Z]?[a-z]+\d*|\d+", name)
    return {name.lower(), *(part.lower() for part in parts)}


def found_in(path: str, source: str) -> list[str]:
    """Return the families' names in a program, each with its place."""
    found = []
    for node in ast.walk(ast.parse(source)):
        named = {word for name in identifiers(node) if name not in STANDARDS for word in words(name)} & NAMES
        looked_up = {key for key in keys(node) if words(key) & NAMES and " " not in key}
        found += [f"{path}:{getattr(node, 'lineno', 0)}: {word!r}" for word in sorted(named | looked_up)]
    return found


def of_this_tree() -> Iterator[str]:
    """Yield the families whose entry points stand in the tree."""
    yield from ENTRY_POINTS["firmware_bridge.families"]


def test_the_names_are_those_of_the_families_of_this_tree() -> None:
    assert {"ar2", "epos2", "motion_capture", "motor_shield"} <= set(of_this_tree()) <= NAMES


def test_nothing_outside_the_families_folders_names_one() -> None:
    files = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
    names = [path.relative_to(ROOT).as_posix() for path in files]
    assert len(names) > 200
    rest = [name for name in names if not name.startswith(THEIR_OWN)]
    assert [each for name in rest for each in found_in(name, (ROOT / name).read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize(
    "planted",
    [
        "epos2_links = {}",
        "class Epos2Axis: pass",
        "from firmware_bridge.families.epos2.settings import Axis",
        "link.shield",
        "if isinstance(link, ShieldLink): pass",
        "DRIVERS = {'epos2-can': make}",
        "if driver == 'motor-shield': pass",
        "def on_maxon_line(): pass",
    ],
)
def test_a_planted_name_is_found(planted: str) -> None:
    assert found_in("firmware_bridge/bridge/planted.py", planted)


@pytest.mark.parametrize(
    "innocent",
    ["text = 'an EPOS2 drives'", "captured = 1", "help('`emulate epos2` emulates it')", "shielded = 2"],
)
def test_other_words_are_free(innocent: str) -> None:
    assert found_in("firmware_bridge/bridge/planted.py", innocent) == []
