"""The scissor lift against the thesis's numbers, and its inverse."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.motion import scissor
from firmware_bridge.robot_types import find

ROBOT = find("rars")
LIFT = ROBOT.geometry.lift
TOP = scissor.highest(LIFT)


def test_the_range_of_the_thesis() -> None:
    # h = N l sin(theta), N = 6, 5 to 45 degrees (2.5): 156 mm collapsed, 1.27 m extended.
    collapsed = 6 * 0.3 * math.sin(math.radians(5))
    assert collapsed == pytest.approx(0.156, abs=1e-3)
    assert collapsed + TOP == pytest.approx(1.27, abs=5e-3)
    assert scissor.travel_from_height(LIFT, TOP) == pytest.approx(
        0.3 * (math.cos(math.radians(5)) - math.sqrt(0.5))
    )


def test_one_turn_of_the_screw_is_one_pitch() -> None:
    height = scissor.height_from_travel(LIFT, 0.0015)
    assert scissor.screw_from_height(LIFT, height) == pytest.approx(2 * math.pi)


def test_collapsed_is_zero() -> None:
    assert scissor.screw_from_height(LIFT, 0.0) == 0.0
    assert scissor.height_from_screw(LIFT, 0.0) == pytest.approx(0.0, abs=1e-12)


@given(st.floats(0, TOP))
def test_height_and_screw_undo_each_other(height: float) -> None:
    assert scissor.height_from_screw(LIFT, scissor.screw_from_height(LIFT, height)) == pytest.approx(
        height, abs=1e-9
    )


@given(st.floats(-1e6, 1e6))
def test_no_reading_of_the_encoder_is_an_error(screw: float) -> None:
    assert -0.16 < scissor.height_from_screw(LIFT, screw) < 1.8


@pytest.mark.parametrize(("extended", "good"), [(5.1, True), (5.0, False), (4.0, False)])
def test_it_extends_upwards(extended: float, *, good: bool) -> None:
    table = LIFT.model_dump() | {"collapsed_angle_deg": 5.0, "extended_angle_deg": extended}
    if good:
        assert type(LIFT).model_validate(table).extended_angle_deg == extended
    else:
        with pytest.raises(ValueError, match="must be larger than collapsed_angle_deg"):
            type(LIFT).model_validate(table)


@pytest.mark.parametrize(("travel", "angle_deg"), [(-1.0, 0.0), (0.0, 5.0), (0.3, 90.0), (1.0, 90.0)])
def test_a_travel_that_it_cannot_make_counts_as_its_nearest_end(travel: float, angle_deg: float) -> None:
    """N l (sin(theta) - sin(5 degrees)); from 5 degrees flat is 1.1 mm on, and upright 0.299 m."""
    rise = math.sin(math.radians(angle_deg)) - math.sin(math.radians(5.0))
    assert scissor.height_from_travel(LIFT, travel) == pytest.approx(6 * 0.3 * rise, abs=1e-9)
