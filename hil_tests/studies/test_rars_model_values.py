"""Check values of RARS's further models (A. P. Das, PhD thesis, IIT Delhi, 2018), its errors corrected."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from validation.rars.castors import Castored
from validation.rars.magic_formula import NEAREST, THROUGH, apart, fitted, friction, peak
from validation.rars.nine_coordinates import Nine, largest_error

SWIVELS = np.array([0.3, -0.2])
SPINS = np.array([4.0, 6.0])


def test_the_castors_roll_and_swivel_so() -> None:
    """(3.13)-(3.30): pivot minus wheel is d1 e - d2 f."""
    turning, rolling = Castored().rates(SWIVELS, SPINS)
    assert turning == pytest.approx([-1.671923, -4.776649], abs=5e-7)
    assert rolling == pytest.approx([5.036095, 4.903294], abs=5e-7)


def test_castors_with_mass_take_so_much_torque() -> None:
    """(3.31)-(3.40)."""
    inertia, coriolis = Castored().matrices(SWIVELS, SPINS)
    assert inertia.ravel() == pytest.approx([0.14961045, -0.05976618, -0.05976618, 0.14985383], abs=5e-9)
    platform = 0.0240625 * np.array([[0.0, -1.0], [1.0, 0.0]])
    assert (coriolis - platform).ravel() == pytest.approx(
        [0.00357338, -0.00669431, 0.00704055, -0.00436423], abs=5e-9
    )
    pushed = Castored().accelerations(SWIVELS, SPINS, np.array([0.5, 0.8]))
    assert pushed == pytest.approx([7.554313, 7.695937], abs=5e-7)


pairs = st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)).map(np.array)


@given(pairs, pairs, pairs, st.floats(-0.02, 0.02))
def test_the_closed_form_is_the_balance_of_every_mass(
    swivels: np.ndarray, spins: np.ndarray, torques: np.ndarray, across: float
) -> None:
    """d'Alembert by differences of velocities; also for a pivot beside its wheel, d1."""
    robot = Castored(across=across)
    needed = robot.balanced(swivels, spins, robot.accelerations(swivels, spins, torques))
    assert needed == pytest.approx(torques, abs=2e-5)


def test_the_nine_coordinates_numbers_of_table_3_1() -> None:
    """(3.70), abar_2 corrected; the front wheels' distance of 0.210 m is assumed."""
    assert Nine().alphas == pytest.approx((43.479487, -7.879487, 39.2725, 71.2), abs=5e-7)


def test_the_nine_coordinates_are_the_sum_of_forces_and_moments() -> None:
    """(3.46)-(3.72) at 200 random rates and accelerations."""
    assert largest_error(Nine()) < 1e-11
    assert (
        largest_error(Nine(front_track=0.3, wheel_mass=2.0, wheel_yaw_inertia=0.1, yaw_inertia=3.2)) < 1e-11
    )


def test_the_magic_formula_goes_through_peak_and_end_coefficients_assumed() -> None:
    """(3.45) through (3.83)'s (0.15, 1) and (1, 0.66)."""
    assert peak(THROUGH) == pytest.approx(0.15, abs=5e-4)
    assert float(friction(THROUGH, 0.15)) == pytest.approx(1.0, abs=1e-6)
    assert float(friction(THROUGH, 1.0)) == pytest.approx(0.66, abs=5e-5)
    assert float(friction(THROUGH, 1e-6)) / 1e-6 == pytest.approx(18.6, abs=0.05)


def test_the_magic_formula_nearest_to_the_thesiss_law_coefficients_assumed() -> None:
    """(3.45) by least squares of (3.83), whose slips are not stated: over even ones another is 5 % nearer."""
    assert apart(NEAREST) == pytest.approx(0.028, abs=0.0015)
    assert 0.95 * apart(NEAREST) < apart(fitted()) <= apart(NEAREST)
    assert peak(NEAREST) == pytest.approx(0.22, abs=0.005)
    assert float(friction(NEAREST, 1.0)) == pytest.approx(0.718, abs=5e-4)
