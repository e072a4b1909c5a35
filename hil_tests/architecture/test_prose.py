"""Docstrings, comments, messages and pages are in the field's words: a list of refused ones, and who may."""

import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

from hil_tests.architecture.test_words import FOLDERS, REFUSED, ROOT

WORD: Final = re.compile(rf"(?<![\w./-])(?:{'|'.join(sorted(REFUSED))})(?![\w-])", re.IGNORECASE)
QUOTED: Final = re.compile(r"`[^`]*`")
NOT_PROSE: Final = (
    "CHANGELOG.md",  # what was called how, before
    "firmware_bridge/renamed.py",  # the table of old words
    "hil_tests/architecture/test_prose.py",
    "hil_tests/architecture/test_words.py",  # the list itself
    "hil_tests/compatibility/",  # what tests the old words, and the frozen package
    "hil_tests/fmu/test_events.py",  # texts of an FMU, whose sources stay as they are
    "hil_tests/fmu/test_plant_shell.py",
    "hil_tests/adversary/found/",  # missions that once failed, as they were found
    "tools/mutate_results.toml",  # lines of code as they were when they were tried
    "tools/mutate_survivors.toml",
)
OLD_WORDS: Final = frozenset(
    {
        ("emulators/testing/hand.py", "told"),
        ("emulators/testing/process.py", "says"),
        ("firmware_bridge/robot_type.py", "asked"),
        ("firmware_bridge/robot_type.py", "wished"),
        ("firmware_bridge/safety/interlock.py", "asked"),
        ("firmware_bridge/safety/snapshot.py", "wish"),
    }
)
"""Names of the release before, which their warnings quote."""


def texts(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the texts of a file, each with its line: of a program its strings and comments."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        yield from enumerate(text.splitlines(), 1)
        return
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in (tokenize.STRING, tokenize.COMMENT):
            yield token.start[0], token.string


def found(path: Path) -> Iterator[tuple[int, str]]:
    """Yield each refused word of a file, with the line where its text begins; quoted code does not count."""
    for line, text in texts(path):
        for match in WORD.finditer(QUOTED.sub("", text)):
            yield line, match[0].lower()


def files() -> Iterator[Path]:
    """Yield programs, pages, templates and tables of the whole tree."""
    for folder in (*FOLDERS, "docs"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in {".py", ".md", ".toml", ".template"} and "build" not in path.parts:
                yield path
    yield from (ROOT / name for name in ("README.md", "pyproject.toml", "setup.py"))


def test_no_text_has_a_refused_word() -> None:
    refused = [
        f"{name}:{line}: {word}"
        for path in files()
        if not (name := str(path.relative_to(ROOT))).startswith(NOT_PROSE)
        for line, word in found(path)
        if (name, word) not in OLD_WORDS
    ]
    assert refused == []


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('"""Return what a drive was told."""\n', ["told"]),
        ("pass  # Nobody asked.\n", ["nobody", "asked"]),
        ('f"{axis} is not heard"\n', ["heard"]),
        ('"""Return `told`, as a retold mission."""\n', []),
        ("told = 1\n", []),
    ],
)
def test_a_word_is_found_in_texts_alone(text: str, words: list[str], tmp_path: Path) -> None:
    path = tmp_path / "it.py"
    path.write_text(text, encoding="utf-8")
    assert [word for _, word in found(path)] == words
