"""Hazards and protective functions: each interlock of each robot has its row, its threshold and its test."""

import ast
import re
from pathlib import Path
from typing import Final

import pytest

from hil_tests.failures.causes import COMMON as COMMON_CAUSES
from hil_tests.failures.causes import LINES, REQUESTED
from hil_tests.failures.drive import CAUSES
from hil_tests.failures.drive import KEPT as OUTCOMES
from hil_tests.failures.rars import FAILS
from hil_tests.hazards import analysis
from hil_tests.hazards.analysis import Analyzed, again
from hil_tests.hazards.axes import AXES
from hil_tests.hazards.common import BESIDE, COMMON
from hil_tests.hazards.page import HEADINGS, protections, rows, sections, unnoticed
from hil_tests.hazards.robots import OWN
from hil_tests.hazards.rows import OWN_CASES

ROOT: Final = Path(__file__).parents[2]
ANALYZED: Final = analysis.KEPT.read()
FUNCTIONS: Final = (*COMMON, *AXES, *BESIDE, *(row for rows in OWN.values() for row in rows))
HAZARD, NAME, SEVERITY, TRIPS, REACTION, DISTANCE, FMEA, RESIDUAL, TEST = range(len(HEADINGS))

each = pytest.mark.parametrize("robot", sorted(LINES))


@each
def test_every_interlock_and_limit_of_a_robot_has_its_row(robot: str) -> None:
    named = [one.function.name for one in protections(robot)]
    assert len(named) == len(set(named))
    assert {row.name for row in OWN[robot]} <= {*named}, "a row is of no interlock of this robot"


@each
def test_a_row_states_hazard_threshold_reaction_and_what_it_leaves(robot: str) -> None:
    for row in rows(robot):
        assert all(row[cell] for cell in range(len(HEADINGS))), row
        assert row[TRIPS] != "-"
        assert row[REACTION] != "-"


@each
def test_the_page_has_the_table_and_begins_with_the_worst_case(robot: str) -> None:
    text = (ROOT / "docs" / "safety" / f"{robot}.md").read_text(encoding="utf-8")
    worst, heading, *rest = sections(robot)
    assert text.index(worst) < text.index(heading)
    assert all(part.replace("](", "](../") in text or part in text for part in rest)


def test_each_severity_is_in_the_legend() -> None:
    (legend,) = re.findall(
        r"\*\*Severity\*\*.*?\n\n", (ROOT / "docs" / "safety.md").read_text(encoding="utf-8"), re.DOTALL
    )
    named = {word.lower() for word in re.findall(r"\*(\w+)\*", legend)} - {"severity"}
    assert {row[SEVERITY] for robot in LINES for row in rows(robot)} - {"-"} == named


def test_each_test_that_a_row_names_is_there() -> None:
    for row in FUNCTIONS:
        file, name = row.test.split("::")
        if file == OWN_CASES.split("::")[0]:
            # The product brings these for every robot.
            file = "emulators/testing/inherited/test_robot.py"
        tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
        names = {one.name for one in ast.walk(tree) if isinstance(one, ast.FunctionDef)}
        assert name in names, row.test


def test_every_row_is_of_some_robot_and_its_causes_are_of_the_matrix() -> None:
    shown = {one.function.name for robot in LINES for one in protections(robot)}
    assert {row.name for row in FUNCTIONS} == shown
    assert {cause for row in FUNCTIONS for cause in row.causes} <= {*CAUSES}


def test_every_cause_that_has_to_stop_a_robot_belongs_to_a_function() -> None:
    """Faults that end by themselves are shorter than these."""
    reacted = {cause for row in FUNCTIONS for cause in row.causes}
    assert {cause.name for cause in (*REQUESTED, *COMMON_CAUSES, *FAILS)} == reacted | {"end of the program"}


@each
def test_a_distance_is_the_longest_that_was_measured_of_its_causes(robot: str) -> None:
    measured = [row for row in OUTCOMES.read() if row.line in LINES[robot] and row.rest_ms >= 0]
    for cells, one in zip(rows(robot), protections(robot), strict=True):
        ways = [row.way_mm for row in measured if row.cause in one.function.causes]
        shown = [int(way) for way in re.findall(r"(\d+) mm,", cells[DISTANCE])]
        assert max(shown, default=0) == max(ways, default=0), cells


@each
def test_the_analysis_is_a_column_and_what_it_found_unnoticed_a_table(robot: str) -> None:
    mine = [row for row in ANALYZED if row.robot == robot]
    noticed = {row.noticed_by for row in mine if not row.why}
    assert noticed, "run tools/measure_fmea.py"
    assert noticed == {cells[NAME] for cells in rows(robot) if cells[FMEA] != "-"}
    assert [cells[-1] for cells in unnoticed(robot)] == [row.why for row in mine if row.why]
    assert all(row.why for row in mine if not row.noticed_by), "late, and no reason is known"


@pytest.mark.long(
    keeps=[
        "rars, axis timeout",
        "climber, second controller",
        "rome, tracking error",
        "ar2, late answer",
        "rome_arm, operator link timeout",
    ]
)
@pytest.mark.parametrize("row", ANALYZED, ids=lambda row: f"{row.robot}, {row.noticed_by or row.kind}")
def test_the_worst_cell_of_an_interlock_is_that_of_the_table(row: Analyzed) -> None:
    assert again(row) == row, "run tools/measure_fmea.py, then make docs"


def test_no_paragraph_of_the_safety_pages_stands_twice() -> None:
    pages = [ROOT / "docs" / "safety.md", *sorted((ROOT / "docs" / "safety").glob("*.md"))]
    seen: dict[str, str] = {}
    for page in pages:
        for part in page.read_text(encoding="utf-8").split("\n\n"):
            words = part.split()
            if part.startswith(("|", "#")) or len(words) < WORDS:
                continue
            text = " ".join(words).replace("](../", "](")
            assert text not in seen, f"{page.name} and {seen[text]}: {text}"
            seen[text] = page.name


WORDS: Final = 21
"""Shorter ones name what a table shows."""


def test_a_function_without_a_threshold_of_its_own_has_a_boundary_case() -> None:
    assert all(row.test == OWN_CASES for row in FUNCTIONS if row.trips is None)
