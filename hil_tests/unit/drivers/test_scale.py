"""SI units to the drive's and back: signs, units, ends, and what is kept on the way there and back."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen_drive.driver.scale import Scale, Travel, highest_speed, travel_of, wrapped
from firmware_bridge.families.epos2.driver.product import configuration
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.robot import Axis
from hil_tests.unit.drivers.robots import LINK, RARS, with_axis

WHEEL = RARS.axis("left_wheel")
"""500 lines, 2000 quadcounts a turn, behind 26:1; top speed 16 rad/s, the drive's limit 4000 rpm."""

RATIOS = st.floats(0.001, 100_000.0)
DIRECTIONS = st.sampled_from((1, -1))
QUADCOUNTS = st.integers(-(2**31), 2**31 - 1)


def axis(ratio: float, direction: int) -> Axis:
    return with_axis(WHEEL, ratio=ratio, direction=direction)


@pytest.mark.parametrize("direction", [1, -1])
def test_one_turn_behind_the_gear_is_so_many_of_the_motor(direction: int) -> None:
    scale = Scale.of(with_axis(WHEEL, direction=direction))
    assert scale.counts(2.0 * math.pi) == direction * 26 * 2000
    assert scale.speed(2.0 * math.pi) == pytest.approx(direction * 26 * 60)


def test_rars_s_gears_are_those_of_its_thesis() -> None:
    """One degree of the pinion is 159 of the motor, one turn of the screw 25 of the motor."""
    assert Scale.of(RARS.axis("steering")).counts(math.radians(1.0)) == round(159 * 2000 / 360)
    assert Scale.of(RARS.axis("lift")).counts(2.0 * math.pi) == 25 * 2000


@pytest.mark.parametrize("direction", [1, -1])
def test_of_an_axis_in_meters_the_ratio_is_radians_a_meter(direction: int) -> None:
    """A wheel of 50 mm behind 26:1 turns its motor by 520 rad in a meter."""
    scale = Scale.of(with_axis(WHEEL, unit="m", ratio=26.0 / 0.05, direction=direction))
    assert scale.counts(1.0) == direction * round(520 * 2000 / (2.0 * math.pi))
    assert scale.speed(0.5) == pytest.approx(direction * 260 * 60 / (2.0 * math.pi))


@given(RATIOS, DIRECTIONS, QUADCOUNTS)
def test_every_quadcount_comes_back(ratio: float, direction: int, quadcounts: int) -> None:
    scale = Scale.of(axis(ratio, direction))
    assert scale.counts(scale.position(quadcounts)) == quadcounts


@given(RATIOS, DIRECTIONS, st.floats(-1e6, 1e6))
def test_a_position_comes_back_within_half_a_quadcount(ratio: float, direction: int, position: float) -> None:
    scale = Scale.of(axis(ratio, direction))
    quantum = abs(1.0 / scale.counts_per_unit)
    back = scale.position(scale.counts(position))
    assert abs(back - position) <= 0.5 * quantum + 4.0 * math.ulp(position)


@given(RATIOS, DIRECTIONS, st.floats(allow_nan=False, allow_infinity=False), QUADCOUNTS, QUADCOUNTS)
def test_what_is_clipped_first_is_what_is_rounded_first(
    ratio: float, direction: int, position: float, one: int, other: int
) -> None:
    scale, travel = Scale.of(axis(ratio, direction)), Travel(min(one, other), max(one, other))
    target = scale.within(position, travel)
    if abs(position) < 1e6:
        assert target == travel.clip(scale.counts(position))
    else:
        assert travel.low <= target <= travel.high


@given(RATIOS, DIRECTIONS, st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_more_is_further_the_way_that_the_direction_states(
    ratio: float, direction: int, one: float, other: float
) -> None:
    scale = Scale.of(axis(ratio, direction))
    low, high = sorted((one, other))
    assert direction * scale.counts(low) <= direction * scale.counts(high)
    assert direction * scale.speed(low) <= direction * scale.speed(high)


@pytest.mark.parametrize(
    ("direction", "travel", "ends"),
    [
        (1, (-0.5, 2.0), (-500, 2000)),
        (-1, (-0.5, 2.0), (-2000, 500)),
        (1, (1.0, 2.0), (1000, 2000)),
        (-1, (1.0, 2.0), (-2000, -1000)),
        (1, (-0.0004, 0.0004), (0, 0)),
        (1, (-0.0006, 0.0006), (-1, 1)),
    ],
)
@pytest.mark.parametrize("unit", ["rad", "m"])
def test_a_travel_in_quadcounts_rises(
    direction: int, travel: tuple[float, float], ends: tuple[int, int], unit: str
) -> None:
    """At pi rad for each unit: half a turn, a thousand quadcounts."""
    slide = with_axis(WHEEL, unit=unit, ratio=math.pi, direction=direction, travel=travel)
    assert travel_of(slide) == Travel(*ends)


def test_an_axis_that_turns_on_and_on_has_none() -> None:
    assert travel_of(WHEEL) is None


def test_rars_s_travels_are_those_of_its_mechanics() -> None:
    """60 degrees of the inner wheel (thesis 2.4, 4.2), and the extended lift (2.5)."""
    assert travel_of(RARS.axis("steering")) == Travel(-134_953, 134_953)
    assert travel_of(RARS.axis("lift")) == Travel(0, 2_890_879)


@pytest.mark.parametrize(
    ("command", "allowed"), [(-100_001, -100_000), (-100_000, -100_000), (0, 0), (100_001, 100_000)]
)
def test_a_travel_clips_at_both_ends(command: int, allowed: int) -> None:
    assert Travel(-100_000, 100_000).clip(command) == allowed


@pytest.mark.parametrize(("top_speed", "rpm"), [(16.0, 3972), (0.001, 0), (20.0, 4000), (1e6, 4000)])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_highest_speed_is_below_both_limits(top_speed: float, rpm: int, direction: int) -> None:
    limited = with_axis(WHEEL, top_speed=top_speed, direction=direction)
    assert highest_speed(limited) == rpm


@given(st.integers(-(2**40), 2**40))
def test_wrapped_is_what_a_counter_of_32_bits_shows(quadcounts: int) -> None:
    shown = wrapped(quadcounts)
    assert -(2**31) <= shown < 2**31
    assert (shown - quadcounts) % 2**32 == 0


def test_a_travel_that_the_drive_cannot_count_is_refused() -> None:
    """2000 quadcounts a turn and a following error of 20000: all of its travel fits the drive's limits."""
    furthest = (2**31 - 1 - 20_000) / 2000.0 * 2.0 * math.pi / 26.0
    whole = with_axis(WHEEL, travel=(-furthest, furthest))
    limits = [
        row for row in configuration(whole, Epos2Link.of_link(RARS, LINK)) if "position limit" in row.name
    ]
    assert [row.value for row in limits] == [-(2**31) + 1, 2**31 - 1]
    with pytest.raises(ValueError, match="all that the drive can count"):
        with_axis(WHEEL, travel=(0.0, furthest * 1.000001))
