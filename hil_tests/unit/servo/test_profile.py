"""Profiles against the closed forms of trapezoids and triangles."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.servo.axis import MOVE, RAMP, ServoAxis
from emulators.servo.profile import move, ramp, stopping_distance
from emulators.servo.scaling import Settings, acceleration_units, configure, speed_units

RPM_PER_QC_MS = 30.0


def axis_for(profile: int, *, speed: int, acceleration: int, deceleration: int) -> ServoAxis:
    axis = ServoAxis("one", 2000)
    configure(axis, Settings())
    axis.profile = profile
    axis.cruise = speed_units(axis, speed)
    axis.acceleration = acceleration_units(axis, acceleration)
    axis.deceleration = acceleration_units(axis, deceleration)
    axis.stopping_distance = stopping_distance(axis.cruise, axis.deceleration)
    return axis


def run_move(axis: ServoAxis, target: int, longest: int = 200_000) -> list[float]:
    """Return the speed (qc/ms) of each ms until the move is done."""
    axis.target_position = target << axis.fraction
    speeds = []
    for _ in range(longest):
        done = move(axis)
        speeds.append(axis.velocity_demand / 2**axis.fraction)
        if done:
            return speeds
    raise AssertionError("never arrives")


def closed_form_ms(way: float, speed: float, up: float, down: float) -> float:
    """Duration of a trapezoid or triangle; qc, qc/ms, qc/ms2."""
    ramps = speed * speed / 2 * (1 / up + 1 / down)
    if way >= ramps:
        return way / speed + speed / 2 * (1 / up + 1 / down)
    peak = (2 * way * up * down / (up + down)) ** 0.5
    return float(peak / up + peak / down)


@given(
    st.integers(1, 400_000),
    st.integers(100, 12_000),
    st.integers(3_000, 100_000),
    st.integers(3_000, 100_000),
    st.sampled_from((1, -1)),
)
def test_a_move_takes_the_time_of_its_trapezoid_and_ends_exactly(
    way: int, speed: int, up: int, down: int, sign: int
) -> None:
    axis = axis_for(MOVE, speed=speed, acceleration=up, deceleration=down)
    target = sign * way
    speeds = run_move(axis, target)
    assert axis.position_demand == target << axis.fraction
    assert axis.velocity_demand == 0
    per_ms = 1 / RPM_PER_QC_MS
    wanted = closed_form_ms(way, speed * per_ms, up * per_ms / 1000, down * per_ms / 1000)
    # Each of the three phases is rounded up to whole ms, and so is the standstill at the end.
    assert len(speeds) == pytest.approx(wanted, abs=6, rel=0.01)


@given(
    st.lists(st.integers(-50_000, 50_000), min_size=2, max_size=6),
    st.lists(st.integers(1, 300), min_size=6, max_size=6),
    st.integers(100, 9000),
)
def test_whatever_the_targets_no_limit_is_passed_and_the_last_is_reached(
    targets: list[int], pauses: list[int], speed: int
) -> None:
    axis = axis_for(MOVE, speed=speed, acceleration=30_000, deceleration=20_000)
    before = 0
    for target, pause in zip(targets, pauses, strict=False):
        axis.target_position = target << axis.fraction
        for _ in range(pause):
            move(axis)
            change = axis.velocity_demand - before
            assert axis.acceleration_demand == change
            assert abs(change) <= max(axis.acceleration, axis.deceleration)
            assert abs(axis.velocity_demand) <= axis.cruise
            before = axis.velocity_demand
    run_move(axis, targets[-1])
    assert axis.position_demand == targets[-1] << axis.fraction


def test_a_move_cut_short_brakes_at_its_deceleration_overshoots_and_returns() -> None:
    axis = axis_for(MOVE, speed=6000, acceleration=60_000, deceleration=60_000)
    axis.target_position = 100_000 << axis.fraction
    for _ in range(300):
        move(axis)
    here = axis.position_demand >> axis.fraction
    speeds = run_move(axis, here)
    assert min(speeds) < 0
    assert axis.position_demand == here << axis.fraction


def test_a_slower_cruise_is_reached_with_the_deceleration() -> None:
    axis = axis_for(MOVE, speed=6000, acceleration=60_000, deceleration=30_000)
    axis.target_position = 1_000_000 << axis.fraction
    for _ in range(300):
        move(axis)
    axis.cruise = speed_units(axis, 3000)
    ms = 0
    while axis.velocity_demand > axis.cruise:
        move(axis)
        ms += 1
    assert ms == pytest.approx(100, abs=1)


@given(st.integers(-8000, 8000), st.integers(-8000, 8000))
def test_a_ramp_takes_the_time_of_its_slopes(start: int, end: int) -> None:
    axis = axis_for(RAMP, speed=8000, acceleration=6600, deceleration=13_200)
    axis.velocity_demand = speed_units(axis, start)
    axis.target_velocity = speed_units(axis, end)
    milliseconds = 1
    while not ramp(axis):
        milliseconds += 1
        assert milliseconds < 10_000
    assert axis.velocity_demand == axis.target_velocity
    slower = abs(start) if start * end < 0 else max(0, abs(start) - abs(end))
    faster = abs(end) if start * end < 0 else max(0, abs(end) - abs(start))
    assert milliseconds == pytest.approx(slower / 13.2 + faster / 6.6, abs=3)


def test_a_ramp_covers_the_way_of_its_triangle() -> None:
    axis = axis_for(RAMP, speed=8000, acceleration=6600, deceleration=6600)
    axis.velocity_demand = speed_units(axis, 3300)
    axis.target_velocity = 0
    while not ramp(axis):
        pass
    # 3300 rpm are 110 qc/ms, for 500 ms, halved.
    assert axis.position_demand / 2**axis.fraction == pytest.approx(27_500, rel=0.003)
