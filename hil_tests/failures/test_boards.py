"""A board that fails in mid-motion ends in a stand, within the way that `docs/safety.md` tells."""

import pytest

from hil_tests.failures.boards import CAUSES, KEPT, RunsOn, seen
from hil_tests.scenarios.rome_ride import FULL

LONGEST_MM = {"firmata": 1_400}
OTHERS_MM = 700


@pytest.mark.long(keeps=["the board is reset, mw", "the board hangs, arduinoio"])
@pytest.mark.parametrize("row", KEPT.read(), ids=lambda row: f"{row.cause}, {row.protocol}")
def test_the_way_is_what_was_measured(row: RunsOn) -> None:
    """The same to the millimetre: time is virtual."""
    cause = next(cause for cause in CAUSES if cause.name == row.cause)
    found = seen(cause, row.protocol)
    assert found.row == row, "another way now: run tools/measure_stops.py, then make docs"
    assert {"axis answers late: one", "axis silent: one"} <= found.holds
    assert not found.armed
    assert not found.powered


def test_each_firmware_is_measured_and_a_boot_is_the_longest_that_a_board_runs_on() -> None:
    """Firmata blinks its version for 2 s before it listens; a cut line is nobody's to mend."""
    rows = KEPT.read()
    assert {(row.cause, row.protocol) for row in rows} == {(c.name, p) for c in CAUSES for p in FULL}
    for row in rows[: 2 * len(FULL)]:
        assert row.way_mm < LONGEST_MM.get(row.protocol, OTHERS_MM)
        assert row.rest_ms < 5_000
