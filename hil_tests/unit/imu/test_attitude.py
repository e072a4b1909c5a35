"""Pitch and roll of an IMU against closed forms: tilt, braking, bias, turns, and how the filter begins."""

import math

import pytest

from emulators.imu.truth import Vector
from firmware_bridge.families.imu.driver.attitude import BIAS_RAD_S, SETTLING, STEADY_RAD_S, Attitude, Phase
from hil_tests.unit.imu.imu_bench import GRAVITY, upwards

CONSTANT_S = 20.0
DT = 0.01
REST: Vector = (0.0, 0.0, 0.0)
UP: Vector = (0.0, 0.0, GRAVITY)


def times(vector: Vector, share: float) -> Vector:
    return vector[0] * share, vector[1] * share, vector[2] * share


def phase_of(filtered: Attitude) -> Phase:
    """Return the phase; a type checker takes an attribute that was compared for settled."""
    return filtered.phase


def settled(force: Vector = UP, bias: Vector = REST) -> Attitude:
    filtered = Attitude(CONSTANT_S)
    for _ in range(SETTLING):
        filtered.step(force, bias, DT)
    assert filtered.phase is Phase.READY
    return filtered


@pytest.mark.parametrize(
    ("pitch", "roll"), [(0.0, 0.0), (30.0, 0.0), (0.0, 30.0), (-20.0, 70.0), (80.0, -45.0)]
)
def test_at_rest_it_is_what_the_accelerometer_has(pitch: float, roll: float) -> None:
    filtered = settled(times(upwards(math.radians(pitch), math.radians(roll)), GRAVITY))
    assert math.degrees(filtered.pitch) == pytest.approx(pitch, abs=1e-9)
    assert math.degrees(filtered.roll) == pytest.approx(roll, abs=1e-9)


def test_a_tilt_that_the_gyro_has_is_there_at_once() -> None:
    filtered, rate = settled(), math.radians(20.0)
    for step in range(1, 51):
        # Nose up is left-handed about y.
        filtered.step(times(upwards(rate * step * DT, 0.0), GRAVITY), (0.0, -rate, 0.0), DT)
    assert math.degrees(filtered.pitch) == pytest.approx(10.0, abs=0.02)
    assert math.degrees(filtered.roll) == pytest.approx(0.0, abs=1e-9)


def test_a_fall_to_the_left_is_a_roll_to_the_negative_side() -> None:
    filtered, rate = settled(), math.radians(300.0)
    for step in range(1, 21):
        filtered.step(times(upwards(0.0, -rate * step * DT), GRAVITY), (-rate, 0.0, 0.0), DT)
    assert math.degrees(filtered.roll) == pytest.approx(-60.0, abs=0.1)


@pytest.mark.parametrize("seconds", [1, 5, 20, 60])
def test_a_step_that_only_the_accelerometer_has_is_followed_with_the_time_constant(seconds: int) -> None:
    filtered, tilt = settled(), math.radians(3.0)
    for _ in range(100 * seconds):
        filtered.step(times(upwards(tilt, 0.0), GRAVITY), REST, DT)
    expected = 3.0 * (1.0 - math.exp(-seconds / CONSTANT_S))
    assert math.degrees(filtered.pitch) == pytest.approx(expected, abs=0.005)


@pytest.mark.parametrize("g", [-0.3, -0.2, 0.144, 0.3])
def test_braking_for_a_second_is_no_slope(g: float) -> None:
    filtered = settled()
    for _ in range(100):
        filtered.step((g * GRAVITY, 0.0, GRAVITY), REST, DT)
    assert abs(math.degrees(filtered.pitch)) < 1.0
    # Without the gate of 0.03 g it would be its share of the apparent slope.
    share = 1.0 - math.exp(-1.0 / CONSTANT_S)
    assert abs(filtered.pitch) <= share * abs(math.atan(g)) + 1e-6


@pytest.mark.parametrize(("g", "counts"), [(1.0299, True), (1.0301, False), (0.9701, True), (0.9699, False)])
def test_the_accelerometer_counts_within_3_percent_of_1_g(g: float, *, counts: bool) -> None:
    filtered = settled()
    for _ in range(100):
        filtered.step(times(upwards(0.1, 0.0), g * GRAVITY), REST, DT)
    assert (filtered.pitch > 1e-3) is counts


def test_in_a_turn_the_accelerometer_counts_a_tenth() -> None:
    bend = (0.0, 0.2 * GRAVITY, GRAVITY)
    found = []
    for rate in (2.9, 3.1):
        filtered = settled()
        for _ in range(500):
            filtered.step(bend, (0.0, 0.0, math.radians(rate)), DT)
        found.append(filtered.roll)
    # The tilt turns with the body, too; within 15 degrees that is a few percent.
    assert found[1] == pytest.approx(found[0] / 10.0, rel=0.15)


def test_the_bias_at_the_first_standstill_is_taken_off() -> None:
    bias = (math.radians(1.0), math.radians(-2.0), math.radians(0.5))
    filtered = settled(bias=bias)
    assert filtered.bias == pytest.approx(bias)
    for _ in range(6_000):
        filtered.step(UP, bias, DT)
    assert max(abs(filtered.pitch), abs(filtered.roll)) < 1e-6


def test_a_bias_that_comes_later_is_bounded_by_the_time_constant() -> None:
    filtered, drift = settled(), math.radians(0.05)
    largest = 0.0
    for _ in range(30_000):
        filtered.step(UP, (0.0, drift, 0.0), DT)
        largest = max(largest, abs(filtered.pitch))
    assert largest == pytest.approx(drift * CONSTANT_S, rel=0.01)


@pytest.mark.parametrize(
    ("rate", "phase"), [(0.999 * BIAS_RAD_S, Phase.READY), (1.001 * BIAS_RAD_S, Phase.MOVING)]
)
def test_a_rate_is_taken_for_a_bias_up_to_5_degrees_a_second(rate: float, phase: Phase) -> None:
    filtered = Attitude(CONSTANT_S)
    for _ in range(SETTLING):
        filtered.step(UP, (0.0, 0.0, rate), DT)
    assert filtered.phase is phase


@pytest.mark.parametrize(
    ("spread", "phase"), [(0.999 * STEADY_RAD_S, Phase.READY), (1.001 * STEADY_RAD_S, Phase.MOVING)]
)
def test_a_robot_that_trembles_more_than_2_degrees_a_second_moves(spread: float, phase: Phase) -> None:
    filtered = Attitude(CONSTANT_S)
    for step in range(SETTLING):
        filtered.step(UP, (spread if step == 50 else 0.0, 0.0, 0.0), DT)
    assert filtered.phase is phase


def test_a_robot_that_comes_to_rest_is_settled_a_second_later() -> None:
    filtered = Attitude(CONSTANT_S)
    for step in range(200):
        filtered.step(UP, (0.0, 0.0, 0.2 * math.sin(step)), DT)
    assert phase_of(filtered) is Phase.MOVING
    for _ in range(SETTLING + 10):
        filtered.step(UP, REST, DT)
    assert phase_of(filtered) is Phase.READY


def test_a_restart_takes_the_accelerometer_again_and_keeps_the_bias_whatever_moves() -> None:
    filtered = settled(bias=(0.0, 0.0, 0.02))
    filtered.restart()
    assert phase_of(filtered) is Phase.SETTLING
    tilted = times(upwards(0.2, 0.0), GRAVITY)
    for step in range(SETTLING):
        # It drives and turns to and fro meanwhile.
        filtered.step(tilted, (0.0, 0.0, 0.02 + (0.05 if step % 2 else -0.05)), DT)
    assert phase_of(filtered) is Phase.READY
    assert filtered.bias == pytest.approx((0.0, 0.0, 0.02))
    assert filtered.pitch == pytest.approx(0.2, abs=1e-3)


def test_between_opposite_directions_there_is_none_and_it_goes_on() -> None:
    filtered = Attitude(CONSTANT_S)
    filtered.step(UP, REST, DT)
    filtered.step(times(UP, -1.0), REST, DT)
    assert filtered.up == (0.0, 0.0, 1.0)


def test_no_force_is_no_direction() -> None:
    filtered = Attitude(CONSTANT_S)
    filtered.step(REST, REST, DT)
    for _ in range(SETTLING):
        filtered.step(UP, REST, DT)
    filtered.step(REST, REST, DT)
    assert phase_of(filtered) is Phase.READY
    assert filtered.pitch == pytest.approx(0.0)
