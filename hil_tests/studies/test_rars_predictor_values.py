"""Check values of RARS's predictor and of its critical delay (A. P. Das, PhD thesis, IIT Delhi, 2018)."""

from typing import Final

import numpy as np
import pytest

from firmware_bridge.motion.model import arc
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.pursuit import critical_delay_s
from validation.rars.dynamic_predictor import (
    RIM,
    SOFT,
    STEP,
    STIFF,
    TRACK,
    Loop,
    by_balance,
    by_wheels,
    followed,
    swing,
    wheel_matrices,
)
from validation.rars.steering_lag import grown

SENT: Final = np.tile((0.5, 0.3), (800, 1))


def test_the_inertia_of_the_wheels_is_that_of_table_3_1() -> None:
    """(3.31)-(3.34), corrected: 2 H."""
    matrix, _ = wheel_matrices()
    assert matrix[0] == pytest.approx([0.10619131, -0.01747631], abs=5e-9)
    assert matrix[1] == pytest.approx([-0.01747631, 0.10619131], abs=5e-9)


@pytest.mark.parametrize(
    ("at_s", "expected"),
    [
        (0.5, (0.248012, 0.017813, 0.145754, 0.505255, 0.302518)),
        (0.8, (0.396100, 0.046442, 0.236197, 0.501430, 0.300772)),
    ],
)
def test_from_rest_the_equation_of_motion_has_these_values_gains_assumed(
    at_s: float, expected: tuple[float, ...]
) -> None:
    """(6.1) with 5 N.m.s/rad and 20 N.m/rad, which are not printed; V 0.5 m/s, W 0.3 rad/s."""
    place = round(at_s / STEP)
    row = by_wheels(STIFF, SENT, np.zeros(7))[place]
    ours = (*row[:3], RIM * row[3:5].mean(), RIM / TRACK * (row[4] - row[3]))
    assert ours == pytest.approx(expected, abs=5e-7)
    assert by_balance(STIFF, SENT)[place] == pytest.approx(ours, abs=1e-11)


@pytest.mark.parametrize(("at_s", "ahead_mm"), [(0.5, 1.4), (0.8, 1.3)])
def test_the_kinematic_model_is_a_millimeter_ahead(at_s: float, ahead_mm: float) -> None:
    row = by_wheels(STIFF, SENT, np.zeros(7))[round(at_s / STEP)]
    model = arc(Pose(0.0, 0.0, 0.0), 0.5, 0.3, at_s)
    assert 1e3 * np.hypot(model.x_m - row[0], model.y_m - row[1]) == pytest.approx(ahead_mm, abs=0.05)


@pytest.mark.parametrize("loop", [STIFF, SOFT], ids=["stiff", "soft"])
def test_with_the_dynamic_predictor_the_delay_is_gone(loop: Loop) -> None:
    """(6.1) over a delay of 0.8 s, above the critical one."""
    assert swing(followed(loop, "none", 20.0)) > 0.1
    assert swing(followed(loop, "dynamic", 20.0)) == pytest.approx(swing(followed(loop, "", 20.0)), abs=1e-6)


@pytest.mark.parametrize(
    ("lag_s", "delay_s"),
    [(0.0, 0.52049), (0.05, 0.47246), (0.1, 0.42876), (0.2, 0.35396), (0.3, 0.29216)],
)
def test_the_critical_delay_of_a_lagging_steering(lag_s: float, delay_s: float) -> None:
    """App. B (B.2), n = v / L = 1 1/s, with the heading that is missing in print."""
    assert critical_delay_s(1.0, 1.0, lag_s) == pytest.approx(delay_s, abs=5e-6)


@pytest.mark.parametrize(
    ("ratio", "delay"), [(1.5, 0.1814), (2.0, 0.3829), (3.0, 0.8209), (5.0, 1.7698), (10.0, 4.2876)]
)
def test_the_axis_of_figure_b_1(ratio: float, delay: float) -> None:
    """tau / T over L / (v T)."""
    for lag_s in (0.1, 1.0):
        assert critical_delay_s(1.0, ratio * lag_s, lag_s) / lag_s == pytest.approx(delay, abs=5e-5)


@pytest.mark.parametrize("lag_s", [1.0, 2.0, 30.0])
def test_a_look_ahead_of_the_way_in_a_lag_swings_without_any_delay(lag_s: float) -> None:
    assert critical_delay_s(1.0, 1.0, lag_s) <= 1e-12


@pytest.mark.parametrize(("share", "grows"), [(0.97, False), (1.03, True)])
def test_by_simulation_an_offset_decays_below_it_and_grows_above(share: float, *, grows: bool) -> None:
    """App. B at 0.97 and 1.03 of the critical delay, lag 0.1 s."""
    assert (grown(share) > 1.0) is grows
