"""Check values of a step of 20 mm under RARS's wheels (A. P. Das, PhD thesis, IIT Delhi, 2018, 2.3)."""

import math

import numpy as np
import pytest

from validation.rars.step import (
    RIM,
    STEP_M,
    STIFF,
    TRACK,
    Sprung,
    contact_m,
    frictions,
    leaves_at,
    loads,
    pushes,
    rises,
)


def test_a_wheel_of_100_mm_meets_the_step_at_53_degrees_40_mm_before_it() -> None:
    """2.3: acos((r - h) / r); the first push is 1.333 of the load: the friction of a driven wheel alone."""
    assert math.degrees(math.acos((RIM - STEP_M) / RIM)) == pytest.approx(53.13, abs=0.005)
    assert contact_m() == pytest.approx(0.040, abs=1e-12)
    assert float(pushes(-contact_m())) == pytest.approx(4.0 / 3.0, abs=1e-12)


def test_the_push_along_the_way_does_the_work_of_lifting() -> None:
    way = np.linspace(-contact_m(), 0.0, 20001)
    assert np.trapezoid(pushes(way), way) == pytest.approx(STEP_M, abs=1e-9)
    # The push is the slope of the axle's way.
    inside = way[1:-1]
    slope = (rises(inside + 1e-7) - rises(inside - 1e-7)) / 2e-7
    assert np.abs(slope - pushes(inside)).max() < 1e-4


@pytest.mark.parametrize(
    ("offset", "pairs", "needed", "energy"),
    [(0.220, (293.0, 399.0), (0.98, 0.49), 5.9), (0.141, (188.0, 505.0), (0.50, 0.25), 3.8)],
)
def test_what_the_step_needs_of_the_rear_wheels(
    offset: float, pairs: tuple[float, float], needed: tuple[float, float], energy: float
) -> None:
    """2.3 with Tab. 3.1's and 2.3.1's centre of mass."""
    assert loads(offset) == pytest.approx(pairs, abs=0.5)
    assert frictions(offset) == pytest.approx(needed, abs=0.005)
    assert loads(offset)[0] * STEP_M == pytest.approx(energy, abs=0.05)


def test_at_half_a_meter_a_second_its_energy_lifts_its_front() -> None:
    moving = 70.6 * 0.5**2 / 2.0
    assert moving == pytest.approx(8.8, abs=0.05)
    assert loads(0.220)[0] * STEP_M < moving


def test_on_a_rectangle_one_raised_corner_loads_its_diagonal_stiffness_assumed() -> None:
    """2.3, Fig. 2.3: k d / 4 on each, 100 N for 2e4 N/m and 20 mm."""
    robot = Sprung(front_track=TRACK)
    change = robot.resting(np.array([STEP_M, 0.0, 0.0, 0.0])) - robot.standing()
    assert change == pytest.approx(STIFF * STEP_M / 4.0 * np.array([1.0, -1.0, -1.0, 1.0]), abs=1e-6)
    assert change[0] == pytest.approx(100.0, abs=1e-6)


def test_the_lightest_wheel_leaves_the_floor_above_29_kilonewtons_a_meter() -> None:
    """147 N on a front wheel of a rectangle; of the trapezium of 2.3.1 above 25.0 kN/m."""
    assert Sprung(front_track=TRACK).standing().min() == pytest.approx(147.0, abs=0.5)
    assert leaves_at(0.220, TRACK) == pytest.approx(29.3e3, abs=50.0)
    assert leaves_at(0.220) == pytest.approx(25.0e3, abs=50.0)


@pytest.mark.long(beside="test_the_lightest_wheel_leaves_the_floor_above_29_kilonewtons_a_meter")
@pytest.mark.parametrize("stiffness", [15e3, 40e3])
def test_driven_over_it_a_wheel_is_in_the_air_on_stiff_springs_only(stiffness: float) -> None:
    _, pushed = Sprung(stiffness).ridden((0, 2))
    assert bool(pushed.min() == 0.0) is (stiffness > leaves_at(0.220))
    assert pushed.min(axis=0).argmin() == 1, "the front wheel beside the raised one"
    # At its end all wheels of one side are up: the body has rolled, and bears as on a plane.
    assert pushed[-1].sum() == pytest.approx(70.0 * 9.81, abs=0.5)
