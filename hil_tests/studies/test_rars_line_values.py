"""Check values of the line of 2 m and of a load aside (A. P. Das, PhD thesis, IIT Delhi, 2018, 4.2.2)."""

import numpy as np
import pytest

from validation.rars.side_load import WAY_M, arc_end, believed, by_balance, driven_line


def test_the_odometry_ends_300_mm_too_long_and_50_mm_aside_radii_assumed() -> None:
    """Fig. 4.12, 4.14: printed 300 and 50 mm; radii of 43.5 mm, 0.76 % apart, are assumed."""
    end = believed()
    assert 1e3 * (end.x_m - WAY_M) == pytest.approx(300.0, abs=3.0)
    assert 1e3 * end.y_m == pytest.approx(50.0, abs=0.5)
    assert (end.x_m, end.y_m) == pytest.approx(arc_end(), abs=1e-4)


def test_a_mass_centre_20_mm_aside_loads_the_wheels_shares_assumed() -> None:
    """Fig. 4.13: M = m g y, half of it on each axle, which is assumed."""
    assert by_balance(0.020) == pytest.approx((13.85, 17.3, 33.0), abs=0.05)


@pytest.mark.long(beside="test_a_mass_centre_20_mm_aside_loads_the_wheels_shares_assumed")
def test_with_the_load_aside_one_motor_takes_more() -> None:
    """Fig. 4.13, through the whole chain: the load's side rolls harder."""
    samples = driven_line("10 kg aside, 161 mm to the left")
    at = samples.seconds
    steady = (at > 10.0) & (at < 13.0)
    left, right = (np.mean(samples.column(f"current_{side}_a")[steady]) for side in ("left", "right"))
    assert left > 1.1 * right
