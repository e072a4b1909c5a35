#!/usr/bin/env python3
"""Counter of lines of code: without blanks, docstrings, comments and imports.

`python tools/code_lines.py [FOLDER ...]` prints a row for each folder below the ones named; by default those
of the product: bridge, emulators, plants. A comment costs nothing, a line that is broken in two counts twice.
"""

import argparse
import ast
import re
import sys
from collections import Counter
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[1]
PRODUCT: Final = ("firmware_bridge", "emulators", "fmu")
C_COMMENT: Final = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
PYTHON: Final = ".py"
C: Final = (".c", ".h")


def python_lines(text: str) -> int:
    """Return how many lines of Python say something; SyntaxError where the text is none."""
    stated = {
        number
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    }
    for node in ast.walk(ast.parse(text)):
        unsaid: ast.stmt | None = None
        if isinstance(node, ast.Import | ast.ImportFrom) or _is_text(node):
            unsaid = node
        if unsaid is not None:
            stated -= set(range(unsaid.lineno, (unsaid.end_lineno or unsaid.lineno) + 1))
    return len(stated)


def _is_text(node: ast.AST) -> bool:
    """Return whether a statement is a string and nothing else: a docstring, or one behind an attribute."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def c_lines(text: str) -> int:
    """Return how many lines of C say something."""
    stated = C_COMMENT.sub(lambda found: "\n" * found[0].count("\n"), text)
    return sum(
        bool(line.strip()) and not line.lstrip().startswith("#include") for line in stated.splitlines()
    )


def lines_of(path: Path) -> int:
    """Return the lines of code in a file; 0 for one that is neither Python nor C."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == PYTHON:
        return python_lines(text)
    return c_lines(text) if path.suffix in C else 0


def counted(folder: Path, endings: tuple[str, ...]) -> Counter[str]:
    """Return the lines of code in each folder directly below this one, and under "." of its own files."""
    rows: Counter[str] = Counter()
    for path in sorted(folder.rglob("*")):
        if path.suffix in endings and "__pycache__" not in path.parts:
            below = path.relative_to(folder).parts
            rows[below[0] if len(below) > 1 else "."] += lines_of(path)
    return rows


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folder", nargs="*", type=Path, default=[ROOT / name for name in PRODUCT])
    python = c = 0
    sys.stdout.write("Python      C\n")
    for folder in parser.parse_args().folder:
        rows, native = counted(folder, (PYTHON,)), counted(folder, C)
        python, c = python + rows.total(), c + native.total()
        sys.stdout.write(f"{rows.total():6d} {native.total():6d}  {folder.name}\n")
        for name in sorted(rows | native):
            sys.stdout.write(f"{rows[name]:6d} {native[name]:6d}    {name}\n")
    sys.stdout.write(f"{python:6d} {c:6d}  together\n")


if __name__ == "__main__":
    main()
