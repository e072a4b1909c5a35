"""What comes of failures and orders is, for every robot, what `docs/safety.md` says of it."""

import pytest

from hil_tests.failures.every_robot import KEPT, LINES, NO_ONE, Row, measured, wanted
from hil_tests.safety.driving import robot_of


@pytest.mark.long(
    keeps=[
        "rars, encoder off",
        "climber, line cut",
        "rome:ros-arduino-bridge, bridge killed",
        "rome:mw:3, board or drive reset",
        "ar2, emergency stop",
        "rome_arm, end of the program",
    ]
)
@pytest.mark.parametrize("row", KEPT.read(), ids=lambda row: f"{row.line}, {row.cause}")
def test_it_comes_to_what_was_measured(row: Row) -> None:
    """The same to the millimetre: time is virtual."""
    assert measured(row.line, row.cause) == row, "run tools/measure_stops.py -k robots, then make docs"


def test_every_robot_has_a_row_for_each_cause_on_each_link() -> None:
    assert [(row.line, row.cause) for row in KEPT.read()] == [key for robot in LINES for key in wanted(robot)]


def test_only_a_board_without_a_watchdog_drives_on() -> None:
    lines = [line for lines in LINES.values() for line in lines]
    unwatched = {line for line in lines if any(link.unwatched for link in robot_of(line).links.values())}
    on = {(row.line, row.cause) for row in KEPT.read() if row.by == NO_ONE}
    assert on == {(line, cause) for line in unwatched for cause in ("bridge killed", "line cut")}
