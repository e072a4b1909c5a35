"""Two driven wheels on one axle: there and back, the pose, and a ramp that never passes its bounds."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.motion.differential import (
    DifferentialRamp,
    fastest_in_turn,
    twist,
    wheel_speeds,
)
from firmware_bridge.motion.tables import DifferentialBase
from firmware_bridge.units import MILLISECOND

BASE = DifferentialBase(wheel_radius_m=0.1, track_m=0.5)
CYCLE = 50 * MILLISECOND
RAMP = DifferentialRamp(0.4, 2.0, 0.6, 0.25, CYCLE)
ROUNDING = 1e-12

speeds = st.floats(-2.0, 2.0)
turns = st.floats(-3.0, 3.0)


@pytest.mark.parametrize(
    ("speed", "turn", "left", "right"),
    [
        (1.0, 0.0, 10.0, 10.0),
        (-1.0, 0.0, -10.0, -10.0),
        (0.0, 2.0, -5.0, 5.0),
        (0.0, -2.0, 5.0, -5.0),
        (1.0, 4.0, 0.0, 20.0),
    ],
)
def test_wheels_of_a_motion(speed: float, turn: float, left: float, right: float) -> None:
    assert wheel_speeds(BASE, speed, turn) == pytest.approx((left, right))
    assert twist(BASE, left, right) == pytest.approx((speed, turn))


@given(speeds, turns)
def test_there_and_back(speed: float, turn: float) -> None:
    assert twist(BASE, *wheel_speeds(BASE, speed, turn)) == pytest.approx((speed, turn), abs=ROUNDING)


def test_the_fastest_in_a_turn() -> None:
    assert fastest_in_turn(0.0, 0.6) == math.inf
    assert fastest_in_turn(1.2, 0.6) == fastest_in_turn(-1.2, 0.6) == 0.5


def allowed(target: tuple[float, float]) -> tuple[float, float]:
    """Return a target as the sideways limit leaves it."""
    speed, turn = target
    fastest = fastest_in_turn(turn, RAMP.sideways_mps2)
    return min(max(speed, -fastest), fastest), turn


@given(st.lists(st.tuples(speeds, turns), min_size=1, max_size=8), st.integers(1, 3))
def test_the_ramp_keeps_every_bound_whatever_it_is_requested(
    targets: list[tuple[float, float]], late: int
) -> None:
    seconds = CYCLE / 1e9
    way = [(0.0, 0.0)]
    for target in targets:
        for _ in range(10):
            way.append(RAMP.step(way[-1], allowed(target), late * CYCLE))
    for (speed, turn), (faster, tighter) in pairwise(way):
        rim = abs(faster - speed) + abs(tighter - turn) * RAMP.half_track_m
        assert rim <= RAMP.acceleration_mps2 * seconds + ROUNDING
        assert abs(tighter - turn) <= RAMP.turn_acceleration_rad_s2 * seconds + ROUNDING
        assert abs(faster * tighter) <= RAMP.sideways_mps2 + ROUNDING


@pytest.mark.parametrize(
    ("commanded", "target", "stepped"),
    [
        ((0.0, 0.0), (1.0, 0.0), (0.02, 0.0)),
        ((0.0, 0.0), (0.0, -1.0), (0.0, -0.08)),
        ((0.0, 0.0), (-1.0, 1.0), (-0.02 / 2.25, 0.1 / 2.25)),
        ((0.0, 0.0), (1.0, -1.0), (0.02 / 2.25, -0.1 / 2.25)),
        ((-0.6, 0.95), (-0.6, 1.5), (-0.6, 1.0)),
        ((0.6, -0.95), (0.6, -1.5), (0.6, -1.0)),
        ((0.6, -1.0), (1.0, -1.0), (0.6, -1.0)),
        ((-0.6, 1.0), (-1.0, 1.0), (-0.6, 1.0)),
        ((0.7, -1.0), (1.0, -1.0), (0.7, -1.0)),
        ((-0.7, 1.0), (-1.0, 1.0), (-0.7, 1.0)),
        ((0.3, -1.9), (1.0, -1.9), (0.6 / 1.9, -1.9)),
        ((-0.3, 1.9), (-1.0, 1.9), (-0.6 / 1.9, 1.9)),
    ],
)
def test_a_step_goes_as_far_as_the_bounds_let_it(
    commanded: tuple[float, float], target: tuple[float, float], stepped: tuple[float, float]
) -> None:
    """Speed alone, turn alone, both by the rim; then the turn, and then the speed, by the pull sideways."""
    assert RAMP.step(commanded, target, CYCLE) == pytest.approx(stepped)


@given(speeds, turns)
def test_the_ramp_arrives_and_stays(speed: float, turn: float) -> None:
    target = allowed((speed, turn))
    at = (0.0, 0.0)
    for _ in range(400):
        at = RAMP.step(at, target, CYCLE)
    assert at == pytest.approx(target, abs=1e-9)
    for _ in range(400):
        at = RAMP.step(at, (0.0, 0.0), CYCLE)
    assert at == (0.0, 0.0)


@pytest.mark.parametrize(("elapsed", "share"), [(0, 0.0), (CYCLE // 2, 0.5), (CYCLE, 1.0), (4 * CYCLE, 1.0)])
def test_a_step_is_as_long_as_its_time_but_no_longer_than_a_cycle(elapsed: int, share: float) -> None:
    assert RAMP.step((0.0, 0.0), (1.0, 0.0), elapsed) == pytest.approx((0.02 * share, 0.0))
