"""The law of pure pursuit, its goal, and the delay at which it begins to swing, worked out in two ways."""

import cmath
import math
from collections import deque

import pytest

from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.paths import circle, line, placed
from firmware_bridge.pilot.pursuit import Pursuit, critical_delay_s


@pytest.mark.parametrize(
    ("pose", "curvature"),
    [
        (Pose(1.0, 0.0, 0.0), 0.0),
        (Pose(1.0, 0.3, 0.0), -2.0 * 0.3 / 0.25),  # r = l2 / (2 x), x to the right (5.3)
        (Pose(1.0, -0.3, 0.0), 2.0 * 0.3 / 0.25),
        (Pose(1.0, 0.0, 0.1), -2.0 * 0.5 * math.sin(0.1) / 0.25),
    ],
)
def test_the_arc_leads_to_the_goal(pose: Pose, curvature: float) -> None:
    arc = Pursuit(line(100.0), 0.5).arc(pose)
    assert arc.curvature_per_m == pytest.approx(curvature, abs=1e-4)
    assert math.dist(arc.goal, (pose.x_m, pose.y_m)) == pytest.approx(0.5, abs=1e-4)


def test_where_the_circle_only_touches_the_path_it_is_enlarged() -> None:
    """The thesis's own start: 4.5 m from the middle of a circle of 5 m, looking outwards."""
    path = placed(circle(5.0), Pose(), offset_m=0.5, turned_rad=-math.pi / 2.0)
    arc = Pursuit(path, 0.5).arc(Pose())
    assert arc.look_ahead_m == pytest.approx(0.55)
    assert math.dist(arc.goal, (0.0, 0.0)) == pytest.approx(0.55, abs=1e-3)
    assert arc.curvature_per_m > 0.0  # the path goes on to the left of who looks outwards


def test_far_from_the_path_it_goes_there() -> None:
    arc = Pursuit(line(100.0), 0.5).arc(Pose(10.0, -7.0, math.pi / 2.0))
    assert 7.0 < arc.look_ahead_m < 7.0 * 1.1
    assert arc.goal[0] > 10.0


def test_the_goal_goes_round_a_closed_path_and_past_the_end_of_an_open_one() -> None:
    around = circle(5.0)
    last = around.at(around.length_m - 0.1)
    assert Pursuit(around, 0.5).arc(last).goal[0] == pytest.approx(0.4, abs=0.01)
    straight = Pursuit(line(3.0), 0.5)
    assert straight.arc(Pose(2.9, 0.0, 0.0)).goal[0] == pytest.approx(3.4, abs=0.01)
    assert not straight.ended
    straight.arc(Pose(3.0, 0.0, 0.0))
    assert straight.ended


@pytest.mark.parametrize(("speed", "look_ahead"), [(0.5, 0.5), (0.25, 0.5), (0.5, 1.0), (0.1, 0.7)])
def test_at_the_critical_delay_a_root_is_on_the_imaginary_axis(speed: float, look_ahead: float) -> None:
    n, delay = speed / look_ahead, critical_delay_s(speed, look_ahead)
    s = 1j * n * math.sqrt(2.0 + 2.0 * math.sqrt(2.0))
    assert abs(s * s + (2.0 * n * s + 2.0 * n * n) * cmath.exp(-s * delay)) < 1e-12
    assert delay * n == pytest.approx(0.5205, abs=1e-4)


@pytest.mark.parametrize(("share", "most"), [(0.9, 0.2), (1.1, None)])
def test_a_point_that_follows_a_line_late_settles_below_it_and_swings_above(
    share: float, most: float | None
) -> None:
    """Integrated by itself, in the plane: the closed form is of the linearized loop."""
    step, speed = 0.005, 0.5
    late = deque([0.0] * round(share * critical_delay_s(speed, 0.5) / step))
    pose, swing, pursuit = Pose(0.0, 0.01, 0.0), 0.0, Pursuit(line(100.0), 0.5)
    reported = 0.0
    for count in range(round(24.0 / step)):
        if count % 2 == 0:
            reported = speed * pursuit.arc(pose).curvature_per_m
        late.append(reported)
        heading = pose.heading_rad + late.popleft() * step
        pose = Pose(
            pose.x_m + speed * step * math.cos(heading), pose.y_m + speed * step * math.sin(heading), heading
        )
        if count * step > 20.0:
            swing = max(swing, abs(pose.y_m))
    if most is None:
        assert swing > 0.02
    else:
        assert swing < most * 0.01
