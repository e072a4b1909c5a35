"""Modules compiled by `setup.py`: they exist, and use nothing that compiled code or rewind cannot handle."""

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def constant(name: str) -> list[str]:
    """Return the texts in a constant of setup.py."""
    for node in ast.parse((ROOT / "setup.py").read_text()).body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.target.id == name:
            assert node.value is not None
            return [str(one.value) for one in ast.walk(node.value) if isinstance(one, ast.Constant)]
    raise LookupError(name)


PATTERNS = constant("WAY_OF_A_PACKET")
INTERPRETED = constant("INTERPRETED")
COMPILED = sorted({file for pattern in PATTERNS for file in ROOT.glob(pattern)})


@pytest.mark.parametrize("pattern", PATTERNS)
def test_each_pattern_finds_something(pattern: str) -> None:
    assert list(ROOT.glob(pattern))


@pytest.mark.parametrize("file", INTERPRETED)
def test_each_exception_is_one(file: str) -> None:
    assert ROOT / file in COMPILED


def test_no_function_changes_a_variable_of_the_one_around_it() -> None:
    """The rewind engine does not see numbers there: see `emulators.rewind.compiled`."""
    guilty = [
        str(file.relative_to(ROOT))
        for file in COMPILED
        if any(isinstance(node, ast.Nonlocal) for node in ast.walk(ast.parse(file.read_text())))
    ]
    assert not guilty


def test_no_protocol_among_them_is_requested_at_run_time() -> None:
    """mypyc makes no class of Python's own of a protocol, and `runtime_checkable` wants one."""
    assert not [str(file) for file in COMPILED if "runtime_checkable" in file.read_text()]


def constants(file: Path) -> Iterator[tuple[str, object]]:
    """Yield a module's constants of a fixed length, by place, with their values."""
    place = file.relative_to(ROOT)
    for node in ast.parse(file.read_text()).body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            annotation = ast.unparse(node.annotation)
            if annotation.startswith("Final") and "..." not in annotation:
                module = importlib.import_module(".".join(place.with_suffix("").parts))
                yield f"{place}:{node.lineno}", getattr(module, node.target.id)


def test_no_constant_is_a_tuple_of_floats_only() -> None:
    """mypyc 2.4 takes such a one for a constant without a value: NameError where it is read.

    `tuple[float, ...]`, and a tuple with anything else in it, are in order.
    """
    guilty = [
        place
        for file in COMPILED
        if str(file.relative_to(ROOT)) not in INTERPRETED
        for place, value in constants(file)
        if isinstance(value, tuple) and value and all(type(one) is float for one in value)
    ]
    assert not guilty


KEYWORDS = frozenset(
    ("alignof", "asm", "complex", "const", "imag", "inline", "real", "restrict", "signed", "thread")
)
"""Words that GNU C also knows with two underscores before them."""


def test_no_attribute_is_a_keyword_of_c() -> None:
    """mypyc puts an underscore before a name: `_signed` would be `__signed`, a keyword of GNU C."""
    guilty = {
        f"{file.relative_to(ROOT)}:{node.lineno}: {node.attr}"
        for file in COMPILED
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.Attribute) and node.attr.startswith("_") and node.attr[1:] in KEYWORDS
    }
    assert not guilty


def test_no_dataclass_has_a_field_of_a_class_that_is_not_there_yet() -> None:
    """mypyc evaluates a field's quoted annotation all the same: importing it crashes."""
    guilty = [
        f"{file.relative_to(ROOT)}:{field.lineno}"
        for file in COMPILED
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.ClassDef)
        and any("dataclass" in ast.unparse(it) for it in node.decorator_list)
        for field in node.body
        if isinstance(field, ast.AnnAssign) and isinstance(field.annotation, ast.Constant)
    ]
    assert not guilty
