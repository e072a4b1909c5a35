"""The scissor lift against the thesis's numbers, and its inverse."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.kinds import find
from firmware_bridge.motion import lift

ROBOT = find("rars")
LIFT = ROBOT.geometry.lift
AXIS = ROBOT.axis("lift")
TOP = lift.highest(LIFT)


def test_the_range_of_the_thesis() -> None:
    # h = N l sin(theta), N = 6, 5 to 45 degrees (2.5): 156 mm collapsed, 1.27 m extended.
    collapsed = 6 * 0.3 * math.sin(math.radians(5))
    assert collapsed == pytest.approx(0.156, abs=1e-3)
    assert collapsed + TOP == pytest.approx(1.27, abs=5e-3)
    assert lift.screw_from_height(LIFT, TOP) == pytest.approx(
        0.3 * (math.cos(math.radians(5)) - math.sqrt(0.5))
    )


def test_one_turn_of_the_screw_is_one_pitch_and_25_turns_of_the_motor() -> None:
    height = lift.height_from_screw(LIFT, 0.0015)
    assert lift.lift_quadcounts(LIFT, AXIS, height) == 25 * 2000


def test_collapsed_is_zero() -> None:
    assert lift.lift_quadcounts(LIFT, AXIS, 0.0) == 0
    assert lift.height_from_quadcounts(LIFT, AXIS, 0) == pytest.approx(0.0, abs=1e-12)


@given(st.floats(0, TOP))
def test_height_and_drive_position_undo_each_other(height: float) -> None:
    counts = lift.lift_quadcounts(LIFT, AXIS, height)
    assert lift.height_from_quadcounts(LIFT, AXIS, counts) == pytest.approx(height, abs=2e-6)


@given(st.integers(-(2**31), 2**31 - 1))
def test_no_reading_of_the_encoder_is_an_error(counts: int) -> None:
    assert -0.16 < lift.height_from_quadcounts(LIFT, AXIS, counts) < 1.8
