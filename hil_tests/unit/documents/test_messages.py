"""The catalog of messages: each text of the source in its place, and a remedy for each class of errors."""

import ast
from pathlib import Path

from validation.pages.messages import ERRORS, PACKAGES, ROOT, Module, answers, errors, interlocks, modules

SOURCE = """
LATE = 'wait, or go on'
def _judge(view):
    if view.late:
        return f"the answer is {view.age:.1f} s old, limit {limit} s" + _more(view)
    return None
def _more(view):
    return "and it was the last one" if view.last else ""
ROWS = (Interlock("late answer", _judge, LATE), Limit(f"limit of {name}", None, "slower"))
LATE: Final = "wait, or go on"
def order():
    if wrong:
        return denied(f"home: {axis} is not there; there are {known}")
    if right:
        return Answer(accepted=True, reason="all is well")
    raise PortError(f"{port}: cannot be opened: {error}")
"""


def module(tmp_path: Path) -> Module:
    path = tmp_path / "source.py"
    path.write_text(SOURCE, encoding="utf-8")
    return Module(path)


def test_an_interlock_has_its_messages_with_what_is_computed_left_open(tmp_path: Path) -> None:
    one, other = interlocks(module(tmp_path))
    assert one.text == "late answer"
    assert one.cause == "the answer is ... s old, limit ... s<br>and it was the last one"
    assert one.remedy == "wait, or go on"
    assert (other.text, other.cause, other.remedy) == ("limit of ...", "-", "slower")


def test_refusals_and_errors_are_found_and_nothing_else(tmp_path: Path) -> None:
    one = module(tmp_path)
    assert list(answers(one)) == [("home", "home: ... is not there; there are ...")]
    assert list(errors(one)) == [("PortError", "...: cannot be opened: ...")]


def test_every_class_with_a_remedy_is_one_of_the_program() -> None:
    known = {
        node.name
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef | ast.FunctionDef)
    }
    assert set(ERRORS) <= known


def test_every_interlock_of_the_program_has_a_remedy() -> None:
    rows = [row for one in modules() for row in interlocks(one)]
    assert {"operator link timeout", "axis timeout", "uncommanded motion"} <= {row.text for row in rows}
    assert all(row.remedy for row in rows)
