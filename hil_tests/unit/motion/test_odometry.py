"""Odometry: counters that wrap, arcs that close, and the error of the thesis's forward Euler beside it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.drivers.driver import Feedback
from firmware_bridge.motion import davis
from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars.kinematics import Rars

ROBOT = find("rars")
RADIUS = ROBOT.geometry.base.wheel_radius_m


def test_a_quarter_circle_ends_where_it_should() -> None:
    # Rear-axle middle on 1 m, wheels on 0.8 and 1.2 m.
    pose = moved(Pose(), 0.8 * math.pi / 2, 1.2 * math.pi / 2, 0.4)
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((1.0, 1.0, math.pi / 2))


@given(st.floats(-1, 1), st.floats(-1, 1), st.integers(2, 40))
def test_an_arc_in_pieces_is_the_same_arc(left: float, right: float, pieces: int) -> None:
    pose = Pose()
    assert (pose.x_m, pose.y_m, pose.heading_rad) == (0.0, 0.0, 0.0)
    for _ in range(pieces):
        pose = moved(pose, left / pieces, right / pieces, 0.4)
    whole = moved(Pose(), left, right, 0.4)
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx(
        (whole.x_m, whole.y_m, whole.heading_rad), abs=1e-9
    )


def test_a_full_circle_closes_where_forward_euler_does_not() -> None:
    # 0.3 m/s at 50 ms on a circle of 415 mm; the thesis (4.13)-(4.15) drifts by up to v dt = 15 mm.
    speed, cycle, radius = 0.3, 0.05, 0.415
    steps = 174
    turn = 2 * math.pi / steps
    pose, euler = Pose(), [0.0, 0.0, 0.0]
    worst = 0.0
    for _ in range(steps):
        pose = moved(pose, (radius - 0.2) * turn, (radius + 0.2) * turn, 0.4)
        euler[0] += radius * turn * math.cos(euler[2])
        euler[1] += radius * turn * math.sin(euler[2])
        euler[2] += turn
        worst = max(worst, math.hypot(euler[0] - pose.x_m, euler[1] - pose.y_m))
    assert math.hypot(pose.x_m, pose.y_m) < 1e-12
    assert 0.5 * speed * cycle < worst <= 1.01 * speed * cycle


def test_the_body_carries_the_pose_on_from_its_two_rear_wheels() -> None:
    body = Rars(ROBOT)
    before = {name: Feedback(name, position=3.0) for name in body.rolling}
    after = {name: Feedback(name, position=3.0 + 1.0 / RADIUS) for name in body.rolling}
    assert body.rolling == ("left", "right")
    pose = body.advanced(Pose(), before, after, {})
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((1.0, 0.0, 0.0))


@given(st.floats(-0.5, 0.5), st.floats(-math.radians(60), math.radians(60)))
def test_odometry_agrees_with_the_steering_geometry(speed: float, steer: float) -> None:
    left, right = davis.wheel_speeds(ROBOT.geometry.base, speed, davis.curvature(ROBOT.geometry.base, steer))
    pose = moved(Pose(), left * 0.05, right * 0.05, 0.4)
    assert pose.heading_rad == pytest.approx(speed * davis.curvature(ROBOT.geometry.base, steer), abs=1e-12)


def test_a_pose_of_which_nothing_is_stated_is_the_origin() -> None:
    assert Pose() == Pose(0.0, 0.0, 0.0)
