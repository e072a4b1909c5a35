"""A wheel whose encoder is off: the base is not long faster than twice its command; the page is true."""

import pytest

from hil_tests.failures.encoders import KEPT, TURNING, Off, measured, wanted

ABOVE_MS = 300


@pytest.mark.long(keeps=["rome:ros-arduino-bridge, before it starts, 200 mm/s"])
@pytest.mark.parametrize(
    "row", KEPT.read(), ids=lambda row: f"{row.line}, {row.when}, {row.commanded_mm_s} mm/s"
)
def test_it_comes_to_what_was_measured(row: Off) -> None:
    """The same to the millimeter: time is virtual."""
    again = measured(row.line, row.when, row.commanded_mm_s / 1000)
    assert again == row, "run tools/measure_stops.py -k encoders, then make docs"


def test_each_line_has_a_row_for_each_speed() -> None:
    rows = [(row.line, row.when, row.commanded_mm_s) for row in KEPT.read()]
    assert rows == [(line, when, round(1000 * reported)) for line, when, reported in wanted()]


def test_a_base_with_the_robot_file_s_usual_cycle_is_soon_no_faster_than_twice_its_command() -> None:
    rows = [row for row in KEPT.read() if row.when == TURNING and row.line.startswith("rome:")]
    assert rows
    for row in rows:
        assert row.worst_mm_s <= 2.1 * row.commanded_mm_s, row
        assert row.above_twice_ms <= ABOVE_MS, row
