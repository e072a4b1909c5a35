"""Davis steering against the thesis's numbers, its inverse functions, and Ackermann's condition."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.motion import davis
from firmware_bridge.robot_types import find

ROBOT = find("rars")
BASE = ROBOT.geometry.base
ANGLES = st.floats(-math.radians(60), math.radians(60))


def test_the_numbers_that_the_thesis_prints() -> None:
    # A. P. Das 2018: 2b/h = a/w (2.12); R(60 deg) = 402 mm (2.13); the real minimum of 415 mm (Tab. 2.1).
    assert BASE.davis_b_m == pytest.approx(0.00612, abs=5e-6)
    assert davis.turn_radius(BASE, math.radians(60)) == pytest.approx(0.402, abs=5e-4)
    assert math.degrees(davis.steer_from_curvature(BASE, 1 / 0.415)) == pytest.approx(58.95, abs=5e-3)


def test_the_pinion_turns_by_360_degrees_for_a_rack_of_its_circumference() -> None:
    # (4.8): phi = x 360/(pi D_p) degrees.
    rack = davis.rack_from_steer(BASE, 0.3)
    assert davis.pinion_from_steer(BASE, 0.3) == pytest.approx(2 * math.pi * rack / (math.pi * 0.030))


@given(ANGLES)
def test_left_and_right_mirror_each_other(steer: float) -> None:
    assert davis.rack_from_steer(BASE, -steer) == -davis.rack_from_steer(BASE, steer)
    assert davis.curvature(BASE, -steer) == -davis.curvature(BASE, steer)
    assert davis.pinion_from_steer(BASE, -steer) == -davis.pinion_from_steer(BASE, steer)
    rack = davis.rack_from_steer(BASE, steer)
    assert davis.outer_from_rack(BASE, -rack) == -davis.outer_from_rack(BASE, rack)
    left, right = davis.wheel_speeds(BASE, 0.3, davis.curvature(BASE, steer))
    assert davis.wheel_speeds(BASE, 0.3, davis.curvature(BASE, -steer)) == pytest.approx((right, left))


@given(ANGLES)
def test_each_conversion_undoes_the_other(steer: float) -> None:
    assert davis.steer_from_rack(BASE, davis.rack_from_steer(BASE, steer)) == pytest.approx(steer, abs=1e-12)
    bend = davis.curvature(BASE, steer)
    assert davis.steer_from_curvature(BASE, bend) == pytest.approx(steer, abs=1e-12)
    pinion = davis.pinion_from_steer(BASE, steer)
    assert davis.steer_from_pinion(BASE, pinion) == pytest.approx(steer, abs=1e-12)


@given(st.floats(math.radians(0.1), math.radians(60)))
def test_the_radius_is_the_thesis_formula(steer: float) -> None:
    # R = a/2 + w cot(theta) (2.13).
    assert davis.turn_radius(BASE, steer) == pytest.approx(0.105 + 0.515 / math.tan(steer))
    assert davis.turn_radius(BASE, -steer) == davis.turn_radius(BASE, steer)


@given(st.floats(math.radians(0.1), math.radians(60)))
def test_the_rack_moves_the_outer_wheel_less_than_the_inner_one(steer: float) -> None:
    rack = davis.rack_from_steer(BASE, steer)
    outer = davis.outer_from_rack(BASE, rack)
    assert 0 < outer < steer
    # Davis meets Ackermann's cot(outer) - cot(inner) = a/w exactly: subtract (4.6) for both wheels.
    assert 1 / math.tan(outer) - 1 / math.tan(steer) == pytest.approx(0.210 / 0.515)


def test_straight_ahead_both_wheels_turn_alike() -> None:
    assert davis.turn_radius(BASE, 0.0) == math.inf
    assert davis.wheel_speeds(BASE, 0.5, davis.curvature(BASE, 0.0)) == (10.0, 10.0)


@given(st.floats(-0.5, 0.5), st.floats(math.radians(0.1), math.radians(60)))
def test_the_wheels_roll_on_their_own_circles(speed: float, steer: float) -> None:
    # (4.10), (4.11) with m = 200 mm: a left turn is slower at the left.
    radius = davis.turn_radius(BASE, steer)
    left, right = davis.wheel_speeds(BASE, speed, davis.curvature(BASE, steer))
    assert left == pytest.approx(speed / 0.05 * (1 - 0.2 / radius))
    assert right == pytest.approx(speed / 0.05 * (1 + 0.2 / radius))
