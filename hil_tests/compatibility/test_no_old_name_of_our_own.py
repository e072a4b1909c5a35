"""What the project writes for a user, and shows, imports no name of the release before."""

import ast
import warnings
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Final

import pytest

from firmware_bridge.renamed import RenamedWarning

ROOT: Final = Path(__file__).parents[2]
OURS: Final = ("firmware_bridge", "emulators", "fmu")
TEXTS: Final = sorted(
    [*ROOT.glob("emulators/*/starter/templates/**/*.py.template"), *ROOT.glob("examples/**/*.py")]
)


def imports(text: str) -> Iterator[ast.ImportFrom]:
    """Iterate over what a text imports from the project; a template's placeholder is a name here."""
    for node in ast.walk(ast.parse(text.replace("$", "_"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in OURS:
            yield node


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_old_name_is_imported(path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", RenamedWarning)
        for node in imports(path.read_text(encoding="utf-8")):
            module = import_module(node.module or "")
            for alias in node.names:
                if not hasattr(module, alias.name):
                    import_module(f"{node.module}.{alias.name}")


def test_templates_and_examples_are_looked_at() -> None:
    looked_at = {path.name for path in TEXTS if any(imports(path.read_text(encoding="utf-8")))}
    assert {"robot.py.template", "robot.py", "trolley.py"} <= looked_at
