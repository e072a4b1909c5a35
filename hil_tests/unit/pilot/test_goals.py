"""Paths of arcs to a goal: direct where an arc is within reach, by a loop where it is not, or refused."""

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware_bridge.pilot.goals import Curvatures, path_to
from firmware_bridge.pilot.paths import PathError

STUCK_AT_10 = Curvatures(0.05, 0.61)
AHEAD = Curvatures(-0.28, 0.28)


@pytest.mark.parametrize(
    ("goal", "reach"),
    [((5.0, 0.5), AHEAD), ((5.0, -0.5), AHEAD), ((5.0, 0.0), AHEAD), ((3.0, 1.5), STUCK_AT_10)],
)
def test_an_arc_leads_to_a_goal_within_reach(goal: tuple[float, float], reach: Curvatures) -> None:
    path = path_to(goal, reach)
    assert path.points[-1] == pytest.approx(goal)
    assert path.length_m < 1.3 * math.hypot(*goal)


def test_a_goal_on_the_other_side_needs_a_loop_whose_space_is_stated() -> None:
    # A circle of 1/0.55 m to the left, once round, and on along a wide arc: 10 m or more.
    with pytest.raises(
        PathError, match=r"only a loop leads there, 16\.8 m long, from -2\.2 to 3\.0 m ahead and"
    ):
        path_to((3.0, -1.5), STUCK_AT_10)
    path = path_to((3.0, -1.5), STUCK_AT_10, loop=True)
    assert path.points[-1] == pytest.approx((3.0, -1.5))
    assert path.length_m > 10.0


@given(st.floats(-6.0, 6.0), st.floats(-6.0, 6.0), st.floats(-0.6, 0.6))
@example(1.5, 5e-324, 0.0)
@example(1.5, -1e-320, 0.0)
def test_no_path_is_tighter_than_the_range(ahead: float, left: float, stuck: float) -> None:
    reach = Curvatures(stuck - 0.28, stuck + 0.28)
    try:
        path = path_to((ahead, left), reach, loop=True)
    except PathError:
        # Some goals cannot be reached at all, and one at the robot's own place is no path.
        return
    assert path.points[-1] == pytest.approx((ahead, left), abs=1e-9)
    points = path.points
    for before, at, after in zip(points, points[1:], points[2:], strict=False):
        a, b = (
            math.atan2(at[1] - before[1], at[0] - before[0]),
            math.atan2(after[1] - at[1], after[0] - at[0]),
        )
        length = (math.dist(before, at) + math.dist(at, after)) / 2.0
        if length > 0.01:
            bend = math.remainder(b - a, math.tau) / length
            assert reach.low - 1e-3 <= bend <= reach.high + 1e-3
