"""A page that is typed from top to bottom: lines for a shell, and files that its reader writes."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[2]
TUTORIALS: Final = ROOT / "docs/tutorials"
SUFFIXES: Final = {"python": ".py", "yaml": ".yml", "toml": ".toml", "ini": ".dcf"}
"""Of a file that is written, by the kind of its block."""
UNNAMED: Final = "test_silence.py"
"""The front page's test, whose line below it names it."""
BLOCK: Final = re.compile(r"^```(\w+)\n(.*?)^```", flags=re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Command:
    """A line, and what it prints."""

    line: str
    shown: tuple[str, ...]


@dataclass(frozen=True)
class Edit:
    """A file that is written."""

    name: str
    text: str


def steps(text: str) -> Iterator[Command | Edit]:
    """Yield a page's steps in their order: one command line or one file each."""
    for block in BLOCK.finditer(text):
        kind, content = block[1], block[2]
        if kind == "console":
            for entry in re.split(r"^\$ ", content, flags=re.MULTILINE)[1:]:
                line, *shown = entry.splitlines()
                yield Command(line, tuple(shown))
        elif kind in SUFFIXES:
            yield Edit(_name(text[: block.start()], SUFFIXES[kind]), content)


def section(text: str, title: str) -> str:
    """Return the text below a heading of the second level, up to the next one."""
    (found,) = re.findall(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", text, flags=re.DOTALL | re.MULTILINE)
    return str(found)


def _name(before: str, suffix: str) -> str:
    """Return the last file with this suffix that the paragraph before a block names."""
    paragraph = before.rstrip().rpartition("\n\n")[2]
    named = re.findall(rf"`([\w./-]+{re.escape(suffix)})`", paragraph)
    return str(named[-1]) if named else UNNAMED
