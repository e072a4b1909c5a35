"""Limits and supervision of one axis, millisecond by millisecond."""

import pytest

from emulators.servo import loops
from emulators.servo.axis import (
    AT_REST,
    CURRENT,
    CURRENT_LIMITED,
    FOLLOWING_ERROR,
    OVER_CURRENT,
    OVER_VOLTAGE,
    POSITION,
    PROFILE_DONE,
    RAMP,
    TARGET_REACHED,
    UNDER_VOLTAGE,
    VELOCITY,
    ServoAxis,
)
from emulators.servo.loops import millisecond
from emulators.servo.scaling import Settings, configure, speed_units


def axis_with(regulator: int, **raw: int) -> ServoAxis:
    axis = ServoAxis("one", 2000)
    configure(axis, Settings(**raw))
    axis.switch_on()
    axis.regulator = regulator
    return axis


def test_the_velocity_average_is_a_low_pass_with_a_weight_of_a_32nd() -> None:
    axis = axis_with(VELOCITY)
    expected = 0.0
    for ms in range(100):
        millisecond(axis, 10 * (ms + 1))
        expected += (10 - expected) / 32
        assert axis.velocity_average / 2**axis.fraction == pytest.approx(expected, abs=1e-3)


def test_the_position_wraps_as_a_32_bit_register() -> None:
    axis = axis_with(VELOCITY)
    axis.position = 2**31 - 1
    millisecond(axis, 1)
    assert axis.position == -(2**31)


@pytest.mark.parametrize(
    ("continuous", "peak", "tau"), [(10_000, 20_000, 40), (1200, 3000, 40), (800, 2000, 7)]
)
def test_the_output_current_limit_holds_for_a_twentieth_of_the_thermal_time_constant(
    continuous: int, peak: int, tau: int
) -> None:
    axis = axis_with(CURRENT, continuous_current=continuous, peak_current=peak, thermal_time=tau)
    axis.current_setting_ma = peak
    axis.current_ma = peak
    milliseconds = 0
    while not axis.flags & CURRENT_LIMITED:
        millisecond(axis, 0)
        milliseconds += 1
    assert milliseconds == tau * 100 // 20
    assert axis.current_demand_ma == continuous


def test_a_current_between_the_limits_lasts_longer_by_the_squares() -> None:
    axis = axis_with(CURRENT, continuous_current=10_000, peak_current=20_000, thermal_time=40)
    axis.current_setting_ma = axis.current_ma = 15_000
    milliseconds = 0
    while not axis.flags & CURRENT_LIMITED:
        millisecond(axis, 0)
        milliseconds += 1
    assert milliseconds == 200 * (20**2 - 10**2) // (15**2 - 10**2)


def test_the_continuous_current_never_exhausts_the_budget_and_rest_regains_half_of_it() -> None:
    axis = axis_with(CURRENT, continuous_current=10_000, peak_current=20_000, thermal_time=40)
    axis.current_ma = 10_000
    for _ in range(5000):
        millisecond(axis, 0)
    assert not axis.flags & CURRENT_LIMITED
    axis.current_ma = 20_000
    for _ in range(200):
        millisecond(axis, 0)
    assert axis.flags & CURRENT_LIMITED
    axis.current_ma = 0
    milliseconds = 0
    while axis.flags & CURRENT_LIMITED:
        millisecond(axis, 0)
        milliseconds += 1
    assert milliseconds == 300


@pytest.mark.parametrize(
    ("away", "limit", "reported"),
    [
        (2000, 2000, 0),
        (2001, 2000, FOLLOWING_ERROR),
        (-2000, 2000, 0),
        (-2001, 2000, FOLLOWING_ERROR),
        (10**9, 0xFFFF_FFFF, 0),
    ],
)
def test_a_following_error_beyond_0x6065_is_reported(away: int, limit: int, reported: int) -> None:
    axis = axis_with(POSITION, following_error=limit)
    axis.position_demand = away << axis.fraction
    millisecond(axis, 0)
    assert axis.flags & FOLLOWING_ERROR == reported


def test_current_mode_keeps_to_the_limit_and_does_not_drive_past_the_largest_speed() -> None:
    axis = axis_with(CURRENT, peak_current=5000, max_speed=3000)
    axis.current_setting_ma = 9000
    millisecond(axis, 0)
    assert axis.current_demand_ma == 5000
    axis.velocity_average = speed_units(axis, 3300)
    millisecond(axis, 0)
    assert axis.current_demand_ma == 0
    axis.current_setting_ma = -9000
    millisecond(axis, 0)
    assert axis.current_demand_ma == -5000


@pytest.mark.parametrize("regulator", [VELOCITY, POSITION])
def test_an_integrator_does_not_wind_up_while_the_current_is_limited(regulator: int) -> None:
    gains = {"velocity_p": 100, "velocity_i": 5000, "position_p": 20, "position_i": 5000, "position_d": 0}
    axis = axis_with(regulator, peak_current=3000, following_error=0xFFFF_FFFF, **gains)
    axis.current_limit_ma = axis.peak_ma
    axis.velocity_demand = speed_units(axis, 6000) if regulator == VELOCITY else 0
    axis.position_demand = 2000 << axis.fraction
    for _ in range(3000):
        millisecond(axis, 0)
    assert axis.current_demand_ma == 3000
    axis.velocity_demand = -axis.velocity_demand
    axis.position_demand = -axis.position_demand
    milliseconds = 0
    while axis.current_demand_ma > 0:
        millisecond(axis, 0)
        milliseconds += 1
        assert milliseconds < 100


def test_the_position_window_needs_its_time() -> None:
    axis = axis_with(POSITION, position_window=10, position_window_time=5, following_error=0xFFFF_FFFF)
    axis.profile = 2
    axis.cruise = axis.acceleration = axis.deceleration = 1
    axis.target_position = axis.position_demand = 11 << axis.fraction
    for _ in range(20):
        millisecond(axis, 0)
    assert axis.flags & PROFILE_DONE
    assert not axis.flags & TARGET_REACHED
    reached = []
    for _ in range(8):
        millisecond(axis, 1)
        reached.append(bool(axis.flags & TARGET_REACHED))
    assert reached == [False] * 5 + [True] * 3


def test_without_a_window_the_target_is_reached_with_the_end_of_the_profile() -> None:
    axis = axis_with(VELOCITY)
    axis.profile = RAMP
    axis.target_velocity = 2 * (axis.acceleration << 10)
    axis.acceleration = axis.deceleration = axis.target_velocity // 2
    assert millisecond(axis, 0) is True  # at rest no longer
    assert not axis.flags & TARGET_REACHED
    assert millisecond(axis, 0) is True
    assert axis.flags & TARGET_REACHED
    assert millisecond(axis, 0) is False


def test_rest_is_reported_after_its_time_and_taken_back_at_once() -> None:
    axis = ServoAxis("one", 2000)
    configure(axis, Settings(standstill_window=30, standstill_time=50))
    axis.flags = axis.still_ms = 0
    for _ in range(50):
        assert not millisecond(axis, 0)
    assert millisecond(axis, 0)
    assert axis.flags & AT_REST
    count = 0
    while axis.flags & AT_REST:
        count += 5
        millisecond(axis, count)
    assert axis.velocity_average > axis.rest_window


@pytest.mark.parametrize(
    ("supply", "current", "flag"),
    [
        (9_999, 0, UNDER_VOLTAGE),
        (75_001, 0, OVER_VOLTAGE),
        (24_000, 37_501, OVER_CURRENT),
        (24_000, -37_501, OVER_CURRENT),
    ],
)
def test_what_the_hardware_does_not_stand_is_reported_with_power_or_without(
    supply: int, current: int, flag: int
) -> None:
    axis = ServoAxis("one", 2000)
    configure(axis, Settings())
    axis.supply_mv = supply
    axis.current_ma = current
    assert millisecond(axis, 0)
    assert axis.flags & flag


def test_the_edges_of_the_supply_are_allowed() -> None:
    axis = ServoAxis("one", 2000)
    configure(axis, Settings())
    for supply in (10_000, 75_000):
        axis.supply_mv = supply
        millisecond(axis, 0)
        assert not axis.flags & (UNDER_VOLTAGE | OVER_VOLTAGE)


def test_a_feed_forward_alone_saturates_at_the_limit() -> None:
    axis = axis_with(VELOCITY, velocity_speed_forward=65_535, peak_current=1000)
    axis.current_limit_ma = 1000
    axis.velocity_demand = speed_units(axis, 25_000)
    loops.velocity(axis)
    assert axis.current_demand_ma == 1000
