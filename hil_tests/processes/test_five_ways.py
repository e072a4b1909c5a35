"""Five users' ways to their aim, each in few steps: a step is a line that is typed, or a written file.

The first three are typed by `test_front_page`, as they stand in the tutorials; here their steps are counted.
"""

import re
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Final

import pytest

from hil_tests.processes.tutorial import ROOT, TUTORIALS, Command, Edit, section, steps

SAFETY_PAGES: Final = tuple(sorted((ROOT / "docs/safety").glob("*.md")))
HAZARDS: Final = "Hazards and protective functions"
DECLARED: Final = frozenset(
    re.findall(r"^  (\w+):\n    description", (ROOT / "action.yml").read_text("utf-8"), re.MULTILINE)
)
"""Inputs of the repository's action."""
GUIDES: Final = {name: (ROOT / name).read_text(encoding="utf-8") for name in ("AGENTS.md", "CONTRIBUTING.md")}
OWN_DRIVE: Final = section((TUTORIALS / "motor-and-encoder.md").read_text("utf-8"), "With a parameter file")
BOARD: Final = (TUTORIALS / "board-in-ci.md").read_text(encoding="utf-8")
MASTER: Final = (TUTORIALS / "master-in-ci.md").read_text(encoding="utf-8")
GAMEPAD: Final = (TUTORIALS / "gamepad.md").read_text(encoding="utf-8")


def edits(text: str) -> Iterator[Edit]:
    return (step for step in steps(text) if isinstance(step, Edit))


def lines(text: str) -> list[str]:
    return [step.line for step in steps(text) if isinstance(step, Command)]


@pytest.mark.parametrize(
    ("text", "most", "aims"),
    [
        pytest.param(OWN_DRIVE, 5, ["--encoder 1024", "state enable", "read velocity"], id="own drive"),
        pytest.param(BOARD, 6, ["pytest -q test_board.py"], id="board in CI"),
        pytest.param(MASTER, 6, ["pytest -q test_master.py"], id="master in CI"),
        pytest.param(GAMEPAD, 8, ["new", "--controls gamepad", "drive", "report"], id="gamepad"),
    ],
)
def test_a_way_is_short_and_ends_where_it_should(text: str, most: int, aims: list[str]) -> None:
    typed = lines(text)
    assert 0 < len(list(steps(text))) <= most
    for aim in aims:
        # In their order: each in a line behind that of the one before.
        found = next((place for place, line in enumerate(typed) if aim in line), None)
        assert found is not None, aim
        typed = typed[found:]


@pytest.mark.parametrize("text", [BOARD, MASTER], ids=["board", "master"])
def test_a_workflow_gives_inputs_that_there_are_and_runs_the_page_s_test(text: str) -> None:
    (workflow,) = (edit for edit in edits(text) if edit.name.startswith(".github/workflows/"))
    (given,) = re.findall(r"uses: OWNER/firmware-bridge@REFERENCE\n +with: \{(.*)\}", workflow.text)
    inputs = dict(one.split(": ") for one in given.split(", "))
    assert DECLARED
    assert set(inputs) <= DECLARED
    assert f"pytest -q {inputs['arguments']}" in lines(text)


def hazards(page: str) -> Iterator[Mapping[str, str]]:
    """Yield the rows of a page's table of hazards, by its columns' titles."""
    table = section(page, HAZARDS).partition("\n|")[2].partition("\n\n")[0]
    titles, _, *rows = ([cell.strip() for cell in _cells(line)] for line in f"|{table}".splitlines())
    for row in rows:
        yield dict(zip(titles, row, strict=True))


def _cells(line: str) -> list[str]:
    return re.split(r"(?<!\\)\|", line)[1:-1]


def has_test(file: str, name: str) -> bool:
    """Return whether a test file has a test of this name, written there or inherited."""
    if not (ROOT / file).exists():
        return False
    return callable(getattr(import_module(file.removesuffix(".py").replace("/", ".")), name, None))


@pytest.mark.parametrize("page", SAFETY_PAGES, ids=lambda page: page.stem)
def test_an_assessor_finds_time_reaction_and_test_of_each_hazard_on_one_page(page: Path) -> None:
    rows = list(hazards(page.read_text(encoding="utf-8")))
    assert rows
    for row in rows:
        assert list(row)[-1] == "test"
        # A dash is a statement only of a residual risk: none is known.
        assert row["residual risk"], row
        assert [
            title for title in ("hazard", "trips at", "reaction", "test") if row[title] in {"", "-"}
        ] == [], row
        tests = re.findall(r"`([\w./]+\.py)::(\w+)(?:\[[^`]*\])?`", row["test"])
        assert tests, row
        assert [test for test in tests if not has_test(*test)] == [], row


def test_every_robot_has_its_page_of_hazards() -> None:
    robots = {path.parent.name for path in (ROOT / "firmware_bridge/robots").glob("*/__init__.py")}
    assert robots
    assert robots <= {page.stem for page in SAFETY_PAGES}


def test_a_maintainer_finds_where_an_interlock_goes_in_two_steps() -> None:
    assert "](CONTRIBUTING.md)" in GUIDES["AGENTS.md"]
    (common, own) = re.findall(
        r"An interlock is a row in\s+`([\w/.]+)` \(of every robot\) or in a robot's `([\w.]+)`",
        GUIDES["CONTRIBUTING.md"],
    )[0]
    assert re.search(r"^ +Interlock\($", (ROOT / common).read_text(encoding="utf-8"), re.MULTILINE)
    for rules in (ROOT / "firmware_bridge/robots").glob(f"*/{own}"):
        assert re.search(
            r"\b(Axis)?Interlock\(|\bInterlock\[|\bLimit\(", rules.read_text(encoding="utf-8")
        ), rules


def test_a_maintainer_finds_where_a_robot_goes_in_two_steps() -> None:
    assert re.search(
        r"a robot is a package of its own,\s+which `firmware-bridge new` writes", GUIDES["CONTRIBUTING.md"]
    )
    (example,) = re.findall(
        r"\| `(examples/\w+)/` \| a robot as a package of its own", GUIDES["CONTRIBUTING.md"]
    )
    (shipped,) = re.findall(r"\| `([\w/]+)/` \| a folder for each robot", GUIDES["CONTRIBUTING.md"])
    assert "firmware_bridge.robots" in (ROOT / example / "pyproject.toml").read_text(encoding="utf-8")
    packages = sorted((ROOT / shipped).glob("*/__init__.py"))
    assert packages
    assert [path for path in packages if "ROBOT_TYPE" not in path.read_text(encoding="utf-8")] == []
