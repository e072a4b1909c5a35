"""What stops RARS does so within the way that `docs/safety.md` tells, and whoever has to notice it does."""

from pathlib import Path
from typing import Final

import pytest

from emulators.bench.faults import KINDS
from hil_tests.failures.cases import ALIKE, CAUSES, ELSEWHERE, STORIES, By
from hil_tests.failures.drive import driven
from hil_tests.failures.measured import KEPT, Worst

ROWS: Final = KEPT.read()
HERE: Final = Path(__file__).parent


@pytest.mark.long(
    keeps=[
        "stick let go, can, lifting at 0.1 m/s",
        "bridge's process dead, can, ahead at 0.5 m/s",
        "one encoder stands, can, ahead at 0.5 m/s",
    ]
)
@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.cause}, {row.link}, {row.motion}")
def test_the_worst_way_is_what_was_measured(row: Worst) -> None:
    """The same to the millimetre: time is virtual."""
    cause, draw = row.drawn
    found = driven(cause, draw)
    assert found.came == row.came, (
        "the worst may be another one now: run tools/measure_stops.py, then make docs"
    )
    if cause.tells:
        assert any(name.startswith(cause.tells) for name in found.holds)


def test_every_cause_is_measured_on_each_of_its_links() -> None:
    wanted = {
        (cause.name, link, motion.lifts)
        for cause in CAUSES
        for link in cause.links
        for motion in cause.motions
    }
    assert {(row.cause, row.link, row.drawn[1].motion.lifts) for row in ROWS} == wanted


def test_each_story_is_there() -> None:
    told = "".join(path.read_text(encoding="utf-8") for path in HERE.parent.glob("scenarios/test_*.py"))
    assert [story.test for story in STORIES if f"def {story.test}(" not in told] == []


def test_every_kind_of_fault_is_a_cause_or_says_why_not() -> None:
    caused = {cause.what for cause in CAUSES if cause.by is By.FAULT}
    others = {*ALIKE, *ELSEWHERE}
    assert caused | others == {kind.name for kind in KINDS.values()}
    assert caused & others == set()
    assert set(ALIKE.values()) <= caused
