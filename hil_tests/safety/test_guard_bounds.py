"""The guard's own arithmetic: what travel and top speed are in rpm and quadcounts, to the last one."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen_drive.driver.scale import travel_of
from firmware_bridge.canopen_drive.guard.bounds import Units, ends, highest_speed, speed_per_unit, targets
from firmware_bridge.families.epos2.guard.product import units
from firmware_bridge.robot import Axis, RobotFileError
from hil_tests.safety.guard_robots import RARS, AnAxis, robot_with


def axis(**differs: object) -> Axis:
    return robot_with((AnAxis("one", 1, **differs),)).axes[0]  # type: ignore[arg-type] # a test's shorthand


RPM = Units(2000)


def ends_of(one: Axis) -> tuple[int, int]:
    return ends(one, units(one))


def highest_of(one: Axis) -> int:
    return highest_speed(one, units(one))


@pytest.mark.parametrize(
    ("top_speed", "ratio", "rpm"),
    [
        (16.0, 26.0, 3972),
        (2.0 * math.pi / 60.0 * 4000 / 26.0, 26.0, 4000),
        (2.0 * math.pi / 60.0 * 3999.999 / 26.0, 26.0, 3999),
        (2.0 * math.pi / 60.0 * 7 / 159.0, 159.0, 7),
        (0.1, 1.0, 0),
    ],
)
@pytest.mark.parametrize("direction", [1, -1])
def test_the_highest_speed_is_the_largest_whole_one_within_the_top_speed(
    top_speed: float, ratio: float, rpm: int, direction: int
) -> None:
    one = axis(top_speed=top_speed, ratio=ratio, direction=direction)
    assert highest_of(one) == rpm
    assert targets(one, units(one)) == range(-rpm, rpm + 1)


@given(rpm=st.integers(1, 25_000), ratio=st.floats(0.01, 1000.0))
def test_a_top_speed_that_was_meant_as_whole_rpm_is_that_many(rpm: int, ratio: float) -> None:
    assert highest_of(axis(top_speed=rpm * 2.0 * math.pi / 60.0 / ratio, ratio=ratio)) == rpm


def test_the_speed_of_a_mirrored_axis_has_the_other_sign() -> None:
    assert speed_per_unit(axis(ratio=math.pi), RPM) == pytest.approx(30.0)
    assert speed_per_unit(axis(ratio=math.pi, direction=-1), RPM) == pytest.approx(-30.0)


@pytest.mark.parametrize(
    ("travel", "direction", "both"),
    [
        ((0.0, 2.0 * math.pi), 1, (0, 2000)),
        ((0.0, 2.0 * math.pi), -1, (-2000, 0)),
        ((-math.pi, math.pi / 2.0), 1, (-1000, 500)),
        ((-math.pi, math.pi / 2.0), -1, (-500, 1000)),
        ((0.0, 2.0 * math.pi * 1000.4 / 2000.0), 1, (0, 1000)),
        ((0.0, 2.0 * math.pi * 1000.6 / 2000.0), 1, (0, 1001)),
    ],
)
def test_the_ends_are_the_nearest_quadcounts_of_the_travel(
    travel: tuple[float, float], direction: int, both: tuple[int, int]
) -> None:
    one = axis(travel=travel, direction=direction, ratio=1.0)
    assert ends_of(one) == both
    assert targets(one, units(one)) == range(both[0], both[1] + 1)


def test_lines_of_the_encoder_and_the_gear_both_count() -> None:
    assert ends_of(axis(travel=(0.0, 2.0 * math.pi), ratio=3.0, encoder_lines=16)) == (0, 192)


def test_an_axis_without_travel_may_go_nowhere() -> None:
    assert ends_of(axis()) == (0, 0)


def test_the_ends_of_rars_are_those_of_its_thesis() -> None:
    """60 degrees of the inner wheel are 2.666 rad at the pinion; the screw makes 57.8 turns."""
    assert ends_of(RARS.axis("steering")) == (-134_953, 134_953)
    assert ends_of(RARS.axis("lift")) == (0, 2_890_879)


@given(
    low=st.floats(-400.0, 400.0),
    length=st.floats(0.01, 400.0),
    ratio=st.floats(0.5, 300.0),
    direction=st.sampled_from([1, -1]),
    lines=st.integers(16, 5000),
)
def test_guard_and_driver_agree_on_the_ends(
    *, low: float, length: float, ratio: float, direction: int, lines: int
) -> None:
    """They share no code; the drive's position limits are written by one and let through by the other."""
    travel = (low, low + length)
    one = axis(travel=travel, ratio=ratio, direction=direction, encoder_lines=lines)
    theirs = travel_of(one)
    assert theirs is not None
    assert ends_of(one) == (theirs.low, theirs.high)


PAIR = (AnAxis("left", 1), AnAxis("right", 2), AnAxis("arm", 3, travel=(0.0, 1.0)))


@pytest.mark.parametrize(
    ("rules", "problem"),
    [
        (
            {"sums": {"all": ({"left": 1.0, "arm": 1.0}, 1.0)}},
            "guard.sums[0].of.arm: is commanded by position",
        ),
        ({"sums": {"all": ({"lift": 1.0}, 1.0)}}, "guard.sums[0].of.lift: no such axis; perhaps 'left'?"),
        (
            {"exclusive": (("left", "right"), ("right",))},
            "guard.exclusive[0].other: 'right' is on the side 'one'",
        ),
        ({"exclusive": (("left",), ("harm",))}, "guard.exclusive[0].other: no axis 'harm'; perhaps 'arm'?"),
        ({"exclusive": (("rigth",), ("arm",))}, "guard.exclusive[0].one: no axis 'rigth'; perhaps 'right'?"),
    ],
)
def test_rules_that_make_no_sense_are_refused_by_their_key(rules: dict[str, Any], problem: str) -> None:
    with pytest.raises(RobotFileError) as refused:
        robot_with(PAIR, **rules)
    assert str(refused.value).startswith(f"a test: {problem}")
