"""Three omni wheels in closed form: the signs of each wheel, the way back, the ramp, the arc."""

import math
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.motion.omni import BodyTwist, OmniRamp, moved, rims, shortened, twist
from firmware_bridge.motion.pose import Pose
from firmware_bridge.units import MILLISECOND

L: Final = 0.16
HALF_ROOT: Final = math.sqrt(3.0) / 2.0
speeds = st.floats(-2.0, 2.0)


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        (BodyTwist(1.0, 0.0, 0.0), (0.0, -HALF_ROOT, HALF_ROOT)),
        (BodyTwist(0.0, 1.0, 0.0), (1.0, -0.5, -0.5)),
        (BodyTwist(0.0, 0.0, 1.0), (L, L, L)),
    ],
    ids=["ahead", "left", "counter-clockwise"],
)
def test_each_wheel_turns_as_the_thesis_states(motion: BodyTwist, expected: tuple[float, ...]) -> None:
    """(2.13) at psi = 0: rows (0, 1, L), (-sin 120, cos 120, L), (sin 120, cos 120, L)."""
    assert rims(motion, L) == pytest.approx(expected, abs=1e-15)


@given(speeds, speeds, speeds)
def test_the_wheels_determine_the_motion_and_the_motion_the_wheels(a: float, b: float, c: float) -> None:
    assert twist(rims(BodyTwist(a, b, c), L), L) == pytest.approx((a, b, c), abs=1e-12)
    assert rims(twist((a, b, c), L), L) == pytest.approx((a, b, c), abs=1e-12)


@given(speeds, speeds, speeds)
def test_a_motion_that_is_too_fast_for_a_rim_keeps_its_direction(a: float, b: float, c: float) -> None:
    wanted, slow = BodyTwist(a, b, c), shortened(BodyTwist(a, b, c), L, 0.5)
    assert max(map(abs, rims(slow, L))) <= 0.5 * (1.0 + 1e-12)
    fastest = max(map(abs, rims(wanted, L)))
    share = min(1.0, 0.5 / fastest) if fastest else 1.0
    assert slow == pytest.approx(tuple(share * it for it in wanted), abs=1e-12)


def test_a_quarter_of_a_circle_is_exact_in_one_step() -> None:
    """Ahead by the arc while it turns: the end lies a radius ahead and a radius to the left."""
    end = moved(Pose(), BodyTwist(math.pi / 2.0, 0.0, math.pi / 2.0))
    assert (end.x_m, end.y_m, end.heading_rad) == pytest.approx((1.0, 1.0, math.pi / 2.0))
    sideways = moved(Pose(1.0, 2.0, math.pi / 2.0), BodyTwist(0.0, 0.5, 0.0))
    assert (sideways.x_m, sideways.y_m) == pytest.approx((0.5, 2.0))


def test_the_ramp_goes_straight_to_its_target_and_no_faster_than_either_bound() -> None:
    ramp = OmniRamp(0.5, 2.0, 50 * MILLISECOND)
    step = ramp.step(BodyTwist(0.0, 0.0, 0.0), BodyTwist(0.3, 0.4, 0.1), 50 * MILLISECOND)
    assert step == pytest.approx((0.015, 0.02, 0.005))
    turns = ramp.step(BodyTwist(0.0, 0.0, 0.0), BodyTwist(0.0, 0.01, 1.0), 50 * MILLISECOND)
    assert turns == pytest.approx((0.0, 0.001, 0.1))
    assert ramp.step(step, BodyTwist(0.016, 0.02, 0.005), 50 * MILLISECOND) == (0.016, 0.02, 0.005)


@pytest.mark.parametrize("turn", [-1.0, 1.0])
def test_a_turn_to_either_side_is_ramped_and_rolled_alike(turn: float) -> None:
    """Ahead and to the left on the arc of a quarter turn, from 30 degrees: its chord in closed form."""
    ramp = OmniRamp(0.6, 4.0, 50 * MILLISECOND)
    after = ramp.step(BodyTwist(0.0, 0.0, 0.0), BodyTwist(0.0, 0.0, turn), 50 * MILLISECOND)
    assert after.turn == pytest.approx(0.2 * turn)
    angle = turn * math.pi / 2.0
    way = BodyTwist(0.3, 0.2, angle)
    begin = Pose(1.0, 2.0, math.radians(30.0))
    end = moved(begin, way)
    # The way, turned by each angle on the arc, in the mean; by parts it is (sin, 1 - cos) over the angle
    along, across = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle
    x, y = 0.3 * along - 0.2 * across, 0.3 * across + 0.2 * along
    cosine, sine = math.cos(begin.heading_rad), math.sin(begin.heading_rad)
    assert end.x_m == pytest.approx(1.0 + x * cosine - y * sine)
    assert end.y_m == pytest.approx(2.0 + x * sine + y * cosine)
    assert end.heading_rad == pytest.approx(begin.heading_rad + angle)


@pytest.mark.parametrize(("elapsed_ms", "ahead"), [(0, 0.0), (25, 0.0125), (50, 0.025), (500, 0.025)])
def test_a_step_is_as_long_as_its_time_but_no_longer_than_a_cycle(elapsed_ms: int, ahead: float) -> None:
    ramp = OmniRamp(0.5, 2.0, 50 * MILLISECOND)
    stepped = ramp.step(BodyTwist(0.0, 0.0, 0.0), BodyTwist(1.0, 0.0, 0.0), elapsed_ms * MILLISECOND)
    assert stepped == pytest.approx((ahead, 0.0, 0.0))


@pytest.mark.parametrize(
    ("way", "end"),
    [
        (BodyTwist(0.5, -0.25, 0.0), Pose(0.5, -0.25, 0.0)),
        (BodyTwist(0.0, 0.0, 1.0), Pose(0.0, 0.0, 1.0)),
        # Sideways on a quarter of a circle: a radius to the left, and one back where it turned left.
        (BodyTwist(0.0, math.pi / 2.0, math.pi / 2.0), Pose(-1.0, 1.0, math.pi / 2.0)),
        (BodyTwist(0.0, math.pi / 2.0, -math.pi / 2.0), Pose(1.0, 1.0, -math.pi / 2.0)),
    ],
)
def test_a_way_along_one_axis_or_on_the_spot(way: BodyTwist, end: Pose) -> None:
    moved_to = moved(Pose(), way)
    expected = (end.x_m, end.y_m, end.heading_rad)
    assert (moved_to.x_m, moved_to.y_m, moved_to.heading_rad) == pytest.approx(expected)
