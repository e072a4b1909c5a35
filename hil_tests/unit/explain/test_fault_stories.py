"""The table of the faults that are named: rows of it measured again, and how many there are."""

import pytest

from emulators.bench.faults import kinds
from hil_tests.unit.explain.fault_stories import CANDIDATE, CAUSES, NAMED, STORIES, Row, rows
from validation.pages.explained_faults import LIMITS, MEASURED, REASONS, overall

AGAIN = (
    ("CAN", "encoder_cut", "supply_surge", "stray_frames"),
    ("board", "board_silent", "board_chatters", "shaft_blocked", "motor_leads_swapped"),
)


def test_every_kind_of_fault_was_measured() -> None:
    assert {kind for kind, _ in MEASURED} == set(kinds())


def test_patterns_and_reasons_are_of_kinds_that_there_are() -> None:
    assert set(CAUSES) <= set(kinds())
    assert set(LIMITS) | set(REASONS) <= set(kinds())
    assert not set(REASONS) & set(CAUSES)


def test_enough_faults_are_named() -> None:
    assert sum(overall(kind) in {NAMED, CANDIDATE} for kind in kinds()) >= 39


@pytest.mark.parametrize(("column", "again"), [(column, kinds) for column, *kinds in AGAIN])
def test_rows_measured_again_are_those_of_the_table(column: str, again: list[str]) -> None:
    story = next(one for one in STORIES if one.column == column)
    found: list[Row] = rows(story, *again)
    assert {row.kind for row in found} == set(again)
    for row in found:
        verdict, shown = MEASURED[row.kind, row.column][row.title]
        assert (row.verdict, row.shown) == (verdict, shown), "measure the table again: see fault_stories.py"
