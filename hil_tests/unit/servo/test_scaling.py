"""The drive's raw gains against their SI meaning (EPOS2 object dictionary, maxon's command library)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.servo import loops
from emulators.servo.axis import POSITION, VELOCITY, ServoAxis
from emulators.servo.scaling import (
    Settings,
    acceleration_units,
    configure,
    raw_speed_rpm,
    speed_rpm,
    speed_units,
)

PULSES = st.sampled_from((16, 100, 500, 512, 1000, 1024, 6400, 2_500_000))
LIMIT = 60_000


def axis_with(**raw: int) -> ServoAxis:
    pulses = raw.get("encoder_pulses", 500)
    axis = ServoAxis("one", 4 * pulses)
    names = ("current_p", "current_i", "velocity_p", "velocity_i", "position_p", "position_i", "position_d")
    settings = dict.fromkeys(names, 0) | {"following_error": 0xFFFF_FFFF} | raw
    configure(axis, Settings(**settings))
    axis.current_limit_ma = LIMIT
    return axis


def radians(axis: ServoAxis, counts: float) -> float:
    return counts * 2 * math.pi / axis.resolution


@given(PULSES, st.integers(1, 32_767), st.integers(-5000, 5000))
def test_velocity_p_is_an_ampere_over_16000_pi_for_each_radian_per_second(
    pulses: int, gain: int, rpm: int
) -> None:
    axis = axis_with(encoder_pulses=pulses, velocity_p=gain)
    axis.velocity_demand = speed_units(axis, rpm)
    loops.velocity(axis)
    amperes = gain / (16_000 * math.pi) * rpm * math.pi / 30
    wanted = max(-LIMIT, min(LIMIT, 1000 * amperes))
    assert axis.current_demand_ma == pytest.approx(wanted, rel=1e-4, abs=1.01)


@given(PULSES, st.integers(1, 10_000))
def test_velocity_i_gains_an_ampere_over_64_pi_in_a_second(pulses: int, gain: int) -> None:
    axis = axis_with(encoder_pulses=pulses, velocity_i=gain)
    axis.velocity_demand = speed_units(axis, 100)
    for _ in range(20):
        loops.velocity(axis)
    amperes = gain / (64 * math.pi) * (100 * math.pi / 30) * 0.020
    assert axis.current_demand_ma == pytest.approx(min(LIMIT, 1000 * amperes), rel=1e-3, abs=1.01)


@given(PULSES, st.integers(1, 32_767), st.integers(-500, 500))
def test_position_p_is_an_ampere_over_32_pi_for_each_radian(pulses: int, gain: int, counts: int) -> None:
    axis = axis_with(encoder_pulses=pulses, position_p=gain)
    axis.position_demand = counts << axis.fraction
    loops.position(axis)
    wanted = max(-LIMIT, min(LIMIT, 1000 * gain / (32 * math.pi) * radians(axis, counts)))
    assert axis.current_demand_ma == pytest.approx(wanted, rel=2e-3, abs=1.01)


@given(PULSES, st.integers(1, 5000))
def test_position_i_gains_an_ampere_over_4_pi_in_a_second(pulses: int, gain: int) -> None:
    axis = axis_with(encoder_pulses=pulses, position_i=gain)
    axis.position_demand = 100 << axis.fraction
    for _ in range(20):
        loops.position(axis)
    amperes = gain / (4.096 * math.pi) * radians(axis, 100) * 0.020
    assert axis.current_demand_ma == pytest.approx(min(LIMIT, 1000 * amperes), rel=2e-3, abs=1.01)


@given(PULSES, st.integers(1, 32_767), st.integers(-3000, 3000))
def test_position_d_is_an_ampere_over_4000_pi_for_each_radian_per_second(
    pulses: int, gain: int, rpm: int
) -> None:
    axis = axis_with(encoder_pulses=pulses, position_d=gain)
    axis.velocity_demand = speed_units(axis, rpm)
    loops.position(axis)
    wanted = max(-LIMIT, min(LIMIT, 1000 * gain / (4000 * math.pi) * rpm * math.pi / 30))
    assert axis.current_demand_ma == pytest.approx(wanted, rel=1e-3, abs=1.01)


@pytest.mark.parametrize("regulator", [VELOCITY, POSITION])
@given(PULSES, st.integers(0, 65_535), st.integers(0, 65_535))
def test_feed_forwards_are_microamperes_for_each_radian_per_second_and_squared_second(
    regulator: int, pulses: int, speed: int, acceleration: int
) -> None:
    of = "velocity" if regulator == VELOCITY else "position"
    raw = {f"{of}_speed_forward": speed, f"{of}_acceleration_forward": acceleration}
    axis = axis_with(encoder_pulses=pulses, **raw)
    axis.velocity_demand = speed_units(axis, 2000)
    axis.acceleration_demand = acceleration_units(axis, 6600)
    (loops.velocity if regulator == VELOCITY else loops.position)(axis)
    microamperes = speed * 2000 * math.pi / 30 + acceleration * 6600 * math.pi / 30
    assert axis.current_demand_ma == pytest.approx(min(LIMIT, microamperes / 1000), rel=1e-3, abs=2.01)


def test_the_derivative_is_filtered_with_a_tenth_of_kd_over_kp() -> None:
    # Thesis (4.5); K_D/K_P = 8 ms x 200/150, a tenth of it is 1.07 ms; sampled at 1 ms, Euler backwards.
    axis = axis_with(position_p=150, position_d=200)
    assert axis.position_filter / 65_536 == pytest.approx(1 / (1 + 0.8 * 200 / 150), rel=1e-4)


@given(PULSES, st.integers(-25_000, 25_000))
def test_speeds_survive_the_way_to_units_and_back(pulses: int, rpm: int) -> None:
    axis = axis_with(encoder_pulses=pulses)
    assert speed_rpm(axis, speed_units(axis, rpm)) == rpm


@pytest.mark.parametrize(
    ("pulses", "step", "rpm"),
    [
        *((500, 1, 30), (500, -1, -30), (500, 0, 0), (500, 137, 4110), (500, -137, -4110)),
        # Recorded of a drive with 256 pulses, n x 58.59375 rpm, and of another one; then halves.
        *((256, 1, 59), (256, 2, 117), (256, 7, 410), (256, 8, 469), (256, 9, 527), (256, 10, 586)),
        *(
            (256, 70, 4102),
            (256, -1, -59),
            (256, -7, -410),
            (1024, 1, 15),
            (1024, 32, 469),
            (1024, -32, -469),
        ),
    ],
)
def test_the_raw_velocity_is_the_quadcounts_of_one_ms_to_the_nearest_rpm(
    pulses: int, step: int, rpm: int
) -> None:
    axis = axis_with(encoder_pulses=pulses)
    axis.step = step
    assert raw_speed_rpm(axis) == rpm


def test_an_acceleration_of_0_still_moves() -> None:
    assert acceleration_units(axis_with(), 0) == 1


def test_a_new_encoder_resolution_keeps_the_position_and_clears_the_demands() -> None:
    axis = axis_with()
    axis.position = 1234
    configure(axis, Settings(encoder_pulses=1024))
    assert axis.resolution == 4096
    assert axis.position_demand >> axis.fraction == 1234
