"""Write the pages of `docs/` that are made from the code's tables: `python tools/make_docs.py`.

A test that reaches an emergency by its cause carries the mark `emergency`, one that goes through a serial
command the mark `opcode`; the pages name them.
"""

# ruff: noqa: INP001 - a script, not a package

import ast
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from firmware_bridge.robot_types import names
from validation.pages.pages import pages

ROOT: Final = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from hil_tests.adversary import beyond  # noqa: E402 - it is found from the checkout only
from hil_tests.failures import encoders  # noqa: E402 - as above
from hil_tests.failures import page as stops  # noqa: E402 - as above
from hil_tests.hazards import page as hazards  # noqa: E402 - as above

EMERGENCY: Final = "emergency"
OPCODE: Final = "opcode"


def marked(mark: str = EMERGENCY) -> Mapping[int, tuple[str, ...]]:
    """Return the names of the tests that are marked with a code, by that code."""
    found: dict[int, list[str]] = {}
    for path in sorted((ROOT / "hil_tests").rglob("test_*.py")):
        text = path.read_text(encoding="utf-8")
        # To read a file as Python takes its time, and most carry no such mark.
        for statement in ast.walk(ast.parse(text)) if f"mark.{mark}" in text else ():
            if isinstance(statement, ast.FunctionDef):
                for code in _codes(statement, mark):
                    found.setdefault(code, []).append(f"`{statement.name}`")
    return {code: tuple(names) for code, names in found.items()}


def _codes(function: ast.FunctionDef, mark: str) -> Iterator[int]:
    for call in function.decorator_list:
        if isinstance(call, ast.Call) and ast.unparse(call.func) == f"pytest.mark.{mark}":
            yield from (each.value for each in call.args if isinstance(each, ast.Constant))


def made() -> Mapping[str, str]:
    """Return every page by its file name."""
    measured = {
        name: (*stops.sections(name), *encoders.sections(name), *beyond.sections(name)) for name in names()
    }
    measured[""] = (*hazards.general(), *stops.general(), *encoders.general())
    protected = {name: hazards.sections(name) for name in names()}
    return pages(marked(EMERGENCY), marked(OPCODE), measured, protected)


def main() -> None:
    """Write them."""
    for name, text in made().items():
        path = ROOT / "docs" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
