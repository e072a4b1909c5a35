"""The sin2 profile against its closed form: shape, duration, peak, way; and its limits at any targets."""

from itertools import pairwise
from math import ceil, pi, sin

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.servo import sine
from emulators.servo.axis import MOVE, RAMP, ServoAxis
from emulators.servo.scaling import Settings, acceleration_units, configure, speed_units


def axis_for(
    profile: int,
    *,
    speed: int = 3000,
    acceleration: int = 30_000,
    deceleration: int = 30_000,
    turn: int = 2000,
) -> ServoAxis:
    axis = ServoAxis("one", turn)
    configure(axis, Settings(encoder_pulses=turn // 4))
    axis.profile = profile
    axis.cruise = speed_units(axis, speed)
    axis.acceleration = acceleration_units(axis, acceleration)
    axis.deceleration = acceleration_units(axis, deceleration)
    return axis


def runs(axis: ServoAxis, longest: int = 400_000) -> list[int]:
    """Return the velocity (units) of each ms to the end of the profile."""
    speeds = []
    for _ in range(longest):
        done = sine.legs(axis)
        speeds.append(axis.velocity_demand)
        if done:
            return speeds
    raise AssertionError("never arrives")


@given(st.integers(0, 1 << 30))
def test_the_share_is_a_squared_sine(part: int) -> None:
    assert sine.share(part) / 2**31 == pytest.approx(sin(pi / 2 * part / 2**31) ** 2, abs=2**-28)


@settings(deadline=None)
@given(st.integers(-12_000, 12_000), st.integers(5000, 200_000))
def test_a_ramp_from_rest_has_shape_duration_peak_and_way_of_its_closed_form(rpm: int, slope: int) -> None:
    axis = axis_for(RAMP, acceleration=slope, deceleration=slope)
    axis.target_velocity = target = speed_units(axis, rpm)
    sine.load(axis)
    speeds = [0, *runs(axis)]
    length = len(speeds) - 1
    # T = pi v / (2 a), in whole ms, an odd number of them.
    wanted = pi * abs(target) / (2 * axis.acceleration)
    assert wanted <= length or target == 0
    assert length <= ceil(wanted * 1.01) + 2
    for ms, speed in enumerate(speeds):
        shape = target * sin(pi * ms / (2 * length)) ** 2
        assert speed == pytest.approx(shape, abs=3)
    steps = [abs(b - a) for a, b in pairwise(speeds)]
    assert max(steps) <= axis.acceleration
    if length > 50:
        assert max(steps) == pytest.approx(axis.acceleration, rel=0.05)
    assert axis.velocity_demand == target
    assert axis.position_demand == pytest.approx(target * (length + 1) / 2, rel=1e-9, abs=1)


@settings(deadline=None)
@given(
    hundredths=st.integers(1, 2000),
    speed=st.integers(500, 12_000),
    up=st.integers(3_000, 100_000),
    down=st.integers(3_000, 100_000),
    sign=st.sampled_from((1, -1)),
    turn=st.sampled_from((64, 2000, 25_600, 1_000_000)),
)
def test_a_move_ends_exactly_within_its_limits_in_the_time_of_its_closed_form(
    *, hundredths: int, speed: int, up: int, down: int, sign: int, turn: int
) -> None:
    way = max(1, hundredths * turn // 100)
    axis = axis_for(MOVE, speed=speed, acceleration=up, deceleration=down, turn=turn)
    axis.target_position = sign * way << axis.fraction
    sine.load(axis)
    speeds = runs(axis)
    assert axis.position_demand == axis.target_position
    assert speeds[-1] == 0
    assert max(map(abs, speeds)) <= axis.cruise
    for before, after in zip([0, *speeds], speeds, strict=False):
        assert abs(after - before) <= (axis.acceleration if abs(after) > abs(before) else axis.deceleration)
    # Ramps take pi/2 times a trapezoid's, and cover pi/2 times its way.
    units = way << axis.fraction
    top = axis.cruise
    slowness = pi / 2 * (1 / axis.acceleration + 1 / axis.deceleration)
    if top * top / 2 * slowness > units:
        top = (2 * units / slowness) ** 0.5
    wanted = units / top + top / 2 * slowness
    assert len(speeds) == pytest.approx(wanted, abs=9, rel=0.02)


@settings(deadline=None)
@given(
    targets=st.lists(st.integers(-50_000, 50_000), min_size=2, max_size=6),
    pauses=st.lists(st.integers(1, 300), min_size=6, max_size=6),
    cruises=st.lists(st.integers(100, 9000), min_size=6, max_size=6),
)
def test_whatever_the_targets_no_limit_is_passed_and_the_last_is_reached(
    targets: list[int], pauses: list[int], cruises: list[int]
) -> None:
    axis = axis_for(MOVE, deceleration=20_000)
    before = 0
    for target, pause, cruise in zip(targets, pauses, cruises, strict=False):
        axis.cruise = speed_units(axis, cruise)
        axis.target_position = target << axis.fraction
        fastest = max(axis.cruise, abs(axis.velocity_demand))
        sine.load(axis)
        for _ in range(pause):
            sine.legs(axis)
            change = axis.velocity_demand - before
            assert axis.acceleration_demand == change
            assert abs(change) <= axis.acceleration
            assert abs(axis.velocity_demand) <= fastest
            before = axis.velocity_demand
    runs(axis)
    assert axis.position_demand == targets[-1] << axis.fraction
    assert axis.velocity_demand == 0


@settings(deadline=None)
@given(st.integers(1, 100_000), st.integers(-200, 200))
def test_a_target_at_the_braking_distance_is_met_from_full_speed(cut: int, beside: int) -> None:
    axis = axis_for(MOVE)
    axis.target_position = 1_000_000 << axis.fraction
    sine.load(axis)
    for _ in range(400):
        sine.legs(axis)
    braking = sine.duration(axis.velocity_demand, axis.deceleration) // 2 * axis.velocity_demand
    axis.target_position = axis.position_demand + braking + beside * cut
    sine.load(axis)
    before = axis.velocity_demand
    for speed in runs(axis):
        assert abs(speed - before) <= axis.deceleration
        before = speed
    assert axis.position_demand == axis.target_position


def test_a_reversal_passes_through_rest() -> None:
    axis = axis_for(RAMP)
    axis.velocity_demand = speed_units(axis, 1000)
    axis.target_velocity = speed_units(axis, -1000)
    sine.load(axis)
    assert 0 in runs(axis)


def test_a_move_at_no_speed_does_not_arrive() -> None:
    axis = axis_for(MOVE, speed=0)
    axis.target_position = 100 << axis.fraction
    sine.load(axis)
    assert not any(sine.legs(axis) for _ in range(100))
    assert axis.position_demand == 0
