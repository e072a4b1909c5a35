"""Names are made of the field's words: a list of those that only this project ever used, and of who may."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

ROOT: Final = Path(__file__).parents[2]
FOLDERS: Final = (
    *("firmware_bridge", "emulators", "fmu", "validation", "examples", "tools", "benchmarks"),
    "hil_tests",
)
REFUSED: Final = frozenset(
    [
        *("told", "tells", "tell", "heard", "hears", "hear", "asked", "asks", "said", "says", "unasked"),
        *("wish", "wished", "wishes", "disbelieved", "disbelief", "parted", "strays", "owes", "limp"),
        *("deaf", "mute", "anew", "nobody", "somebody", "whoever", "evening", "nature"),
        *("stranger", "strangers", "puppet", "mend", "mended", "cure"),
    ]
)
PART: Final = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
OLD_NAMES: Final = frozenset(
    {
        ("firmware_bridge/safety/interlock.py", "asked"),
        ("firmware_bridge/safety/snapshot.py", "wish"),
        ("emulators/testing/hand.py", "told"),
        ("emulators/testing/process.py", "says"),
        ("hil_tests/compatibility/test_old_words.py", "wished"),
    }
)
"""What works for one release more, with a warning that names the new word."""


def refused(name: str) -> bool:
    """Return whether one part of an identifier is a refused word."""
    return not REFUSED.isdisjoint(part.lower() for part in PART.findall(name))


def names(text: str) -> Iterator[tuple[int, str]]:
    """Yield the line and the name of everything that a module defines."""
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                yield node.lineno, name
            case ast.arg(arg=name):
                yield node.lineno, name
            case ast.Name(id=name, ctx=ast.Store()) | ast.Attribute(attr=name, ctx=ast.Store()):
                yield node.lineno, name


def files() -> Iterator[Path]:
    for folder in FOLDERS:
        yield from sorted((ROOT / folder).rglob("*.py"))


def test_no_name_has_a_refused_word() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for path in files()
        for line, name in names(path.read_text(encoding="utf-8"))
        if refused(name) and (str(path.relative_to(ROOT)), name) not in OLD_NAMES
    ]
    assert found == []


def test_no_file_has_one_in_its_name() -> None:
    assert [str(path.relative_to(ROOT)) for path in files() if refused(path.stem)] == []


@pytest.mark.parametrize(
    ("name", "is_refused"),
    [
        *((name, True) for name in ("heard_at", "_wish", "NmtStranger", "NEVER_HEARD", "says_so")),
        *((name, False) for name in ("hearing", "retold", "mission", "received_at")),
    ],
)
def test_a_word_is_a_whole_part_of_a_name(name: str, *, is_refused: bool) -> None:
    assert refused(name) is is_refused
