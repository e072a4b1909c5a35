"""Causes of a stop: each stops the robot within the bounds of `docs/safety.md`, and is noticed in time."""

from pathlib import Path
from typing import Final

import pytest

from emulators.bench.faults import kinds
from hil_tests.failures.causes import COMMON, KILLED, LINE_CUT, ON_BOARDS, STRAIGHT, Fault
from hil_tests.failures.drive import AGAIN, CAUSES, KEPT, NO_ONE, WATCHED_S, Outcome, cases, driven
from hil_tests.failures.rars import ELSEWHERE, SHOWN
from hil_tests.safety.driving import robot_of

ROWS: Final = KEPT.read()
HERE: Final = Path(__file__).parent


@pytest.mark.long(
    keeps=[
        "stick to neutral, rars, lifting at 0.1 m/s",
        "bridge killed, rars, ahead at 0.5 m/s",
        "one encoder stuck, rars, ahead at 0.5 m/s",
        "encoder off, rars, straight ahead",
        "line cut, climber, straight ahead",
        "bridge killed, rome:ros-arduino-bridge, straight ahead",
        "board or drive reset, rome:mw:3, straight ahead",
        "board hangs, rome:arduinoio:3, straight ahead",
        "emergency stop, ar2, straight ahead",
        "end of the program, rome_arm, straight ahead",
    ]
)
@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.cause}, {row.line}, {row.motion}")
def test_a_cause_has_the_outcome_that_was_measured(row: Outcome) -> None:
    """The same to the millimeter: time is virtual."""
    cause = row.case.cause
    found = driven(row.case)
    assert found.outcome == row, "another worst, maybe: run tools/measure_stops.py, then make docs"
    assert not cause.reports or any(name.startswith(cause.reports) for name in found.interlock_events)
    assert found.interlock_events >= {*cause.interlock_events}
    if cause.only:
        assert found.interlock_events == {*cause.interlock_events}
        assert cause.interlock_events or row.by == NO_ONE, "it drives on"
    if cause.codes is not None:
        assert found.codes == cause.codes
    assert found.again == pytest.approx(AGAIN if cause.again else 0.0, rel=0.03)


def test_every_way_to_begin_a_cause_has_its_row() -> None:
    assert {row.case.place for row in ROWS} == {
        case.place for cause in CAUSES.values() for case in cases(cause)
    }


def test_each_test_that_the_page_names_is_there() -> None:
    texts = "".join(path.read_text(encoding="utf-8") for path in HERE.parent.glob("scenarios/test_*.py"))
    assert [row.test for row in SHOWN if f"def {row.test}(" not in texts] == []


def test_every_kind_of_fault_is_a_cause_or_states_why_not() -> None:
    faults = [
        fault
        for cause in CAUSES.values()
        if cause.fault is not None
        for fault in ([cause.fault] if isinstance(cause.fault, Fault) else cause.fault.values())
    ]
    assert {fault.kind for fault in faults} | {*ELSEWHERE} == {*kinds()}
    assert {fault.kind for fault in faults} & {*ELSEWHERE} == set()


def test_only_a_board_without_a_watchdog_drives_on() -> None:
    common = {cause.name for cause in COMMON}
    unwatched = {line for line in ON_BOARDS if any(one.unwatched for one in robot_of(line).links.values())}
    on = {(row.cause, row.line) for row in ROWS if row.by == NO_ONE and row.cause in common}
    assert on == {(cause.name, line) for line in unwatched for cause in (KILLED, LINE_CUT)}


def test_the_longest_that_a_board_runs_on_is_the_boot_of_firmata() -> None:
    """It blinks its version for 2 s before it listens; a line that stays cut cannot be repaired."""
    boots = [
        row for row in ROWS if row.cause in {"board or drive reset", "board hangs"} and "rome:" in row.line
    ]
    assert max(row.way_mm for row in boots) < 710
    assert all(0 <= row.rest_ms < 5_000 for row in ROWS if row.cause == "board hangs")


def test_a_fault_that_nothing_has_to_stop_for_is_driven_to_the_end() -> None:
    free = [row for row in ROWS if CAUSES[row.cause].only and not CAUSES[row.cause].interlock_events]
    assert free
    assert all(row.way_mm == pytest.approx(300 * WATCHED_S, rel=0.01) for row in free)
    assert all(row.motion == STRAIGHT.name for row in free)
