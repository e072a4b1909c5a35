"""Check values of computed torque through the steering drive (A. P. Das, PhD thesis, IIT Delhi, 2018)."""

from typing import Final

import numpy as np
import pytest

from validation.rars.computed_torque import (
    LIMITED_MA,
    STEP_M,
    Case,
    apart,
    computed_torque,
    driven,
    largest_current,
    overshoot,
    settled,
    share_that_flows,
)
from validation.rars.steering import response

SECONDS: Final = 3.0
BARE: Final = Case(SECONDS)
FRICTION: Final = Case(SECONDS, dry=True)
COMPENSATED: Final = Case(SECONDS, dry=True, compensated=True)
AT: Final = 800


def test_the_closed_form_does_not_settle_in_the_printed_time() -> None:
    """(3.102) corrected, with Kd 20, Kp 60, Ki 100 of 3.5.2: 24.99 mm after 0.8 s, settled after 2.01 s."""
    times = np.linspace(0.0, SECONDS, 3001)
    rack = response(1.0, times)
    assert 1e3 * STEP_M * rack[AT] == pytest.approx(24.985, abs=5e-4)
    assert overshoot(rack) == pytest.approx(26.688, abs=5e-4)
    assert times[rack.argmax()] == pytest.approx(0.938, abs=5e-4)
    assert settled(times, rack) == pytest.approx(2.012, abs=5e-4)


def test_through_the_drive_the_step_is_that_of_the_closed_form() -> None:
    """(3.99)-(3.102) over CAN and the drive's current loop, without friction."""
    run = driven(BARE)
    closed = response(1.0, run.times)
    assert 1e3 * STEP_M * run.rack[AT] == pytest.approx(24.985, abs=0.06)
    assert overshoot(run.rack) == pytest.approx(overshoot(closed), abs=0.2)
    assert run.times[run.rack.argmax()] == pytest.approx(0.938, abs=0.01)
    assert settled(run.times, run.rack) == pytest.approx(2.012, abs=0.01)
    assert apart(run.rack, closed) < 0.5


def test_friction_that_the_model_has_not_holds_the_rack_back_and_the_compensation_frees_it() -> None:
    """(3.99) with and without the friction of tyres and motor."""
    rough, smooth = driven(FRICTION), driven(COMPENSATED)
    closed = response(1.0, rough.times)
    assert apart(rough.rack, closed) == pytest.approx(18.6, abs=1.0)
    assert overshoot(rough.rack) == pytest.approx(21.9, abs=0.5)
    assert apart(smooth.rack, closed) < 0.8
    assert overshoot(smooth.rack) == pytest.approx(overshoot(closed), abs=0.5)


def test_the_largest_current_is_that_of_the_whole_error_at_rest() -> None:
    """(3.99): M Kp times the step, over the gear and the torque constant; half the drive's 1.2 A."""
    assert largest_current() == pytest.approx(0.5813, abs=5e-5)
    assert driven(BARE).commanded == pytest.approx(largest_current(), abs=0.005)
    assert driven(COMPENSATED).commanded < 1.2


def test_while_the_motor_accelerates_its_current_stays_below_the_set_value() -> None:
    """Back-EMF against the drive's integral term, which removes half of an error in each cycle of 0.1 ms."""
    run = driven(BARE)
    assert share_that_flows() == pytest.approx(0.95772, abs=5e-6)
    share = run.current[2:50] / run.demand[2:50]
    assert np.median(share) == pytest.approx(share_that_flows(), abs=0.005)


def test_a_drive_with_smaller_limits_keeps_them_and_the_step_comes_later() -> None:
    """0x6410: 0.2 A continuously and 0.3 A at the peak, where the step takes 0.58 A."""
    run = driven(Case(SECONDS, limits_ma=LIMITED_MA))
    assert run.commanded > 0.55
    assert np.abs(run.demand).max() == pytest.approx(LIMITED_MA[1] / 1000.0, abs=1e-9)
    assert np.abs(run.current).max() < LIMITED_MA[1] / 1000.0 + 0.005
    assert np.all(run.rack[10:100] < driven(BARE).rack[10:100])


@pytest.mark.parametrize(("cycle_ms", "distance"), [(5, 0.99), (10, 1.93), (20, 3.73), (50, 9.59)])
def test_a_slower_regulator_is_further_from_the_closed_form(cycle_ms: int, distance: float) -> None:
    """(3.102) knows no cycle; the source gives none. % of the step."""
    run = driven(Case(SECONDS, cycle_ms=cycle_ms))
    assert apart(run.rack, response(1.0, run.times)) == pytest.approx(distance, abs=0.1)


def test_the_study_holds_its_bounds() -> None:
    """(3.99)-(3.102), 3.5.1, 3.5.2, Fig. 3.23, 3.24."""
    findings = computed_torque(quick=True)
    assert findings.out_of_bounds == ()
    limits = {row[0]: row[1:] for row in findings.sheets[0].rows}
    assert limits["without friction"][:2] == (1.2, 3.0)
