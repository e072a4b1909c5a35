"""A tool by rates of joints: how errors die away, singular postures without a jump, limits, ramp and sine."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from firmware_bridge.motion.chain import Matrix
from firmware_bridge.motion.resolved_rate import (
    ALL,
    POSITION,
    Damping,
    pose_law,
    position_error_law,
    resolved,
    slowed,
)
from firmware_bridge.robots.ar2.arm import AR2
from hil_tests.rows import every

STEP = 0.01
BEGIN = np.radians((10.0, -70.0, 60.0, 20.0, 40.0, -10.0))
PLANAR = (0, 2, 4)
"""x, z and pitch, which joints 2, 3 and 5 move."""
THREE = (1, 2, 4)


def turned(axis: tuple[float, float, float], angle: float) -> Matrix:
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: Matrix = np.eye(3) + math.sin(angle) * skew + (1.0 - math.cos(angle)) * skew @ skew
    return rotation


def test_a_places_error_dies_away_by_its_gain() -> None:
    angles, desired = BEGIN.copy(), AR2.pose(BEGIN)[:3, 3] + (0.02, -0.03, 0.01)
    first = np.linalg.norm(desired - AR2.pose(angles)[:3, 3])
    for _ in range(100):
        wanted = position_error_law(desired, AR2.pose(angles)[:3, 3], np.zeros(3), 2.0)
        angles += STEP * resolved(AR2, angles, wanted, rows=POSITION).joints
    left = np.linalg.norm(desired - AR2.pose(angles)[:3, 3])
    assert left == pytest.approx(first * (1.0 - 2.0 * STEP) ** 100, rel=0.01)


def test_a_poses_error_dies_away_from_a_stated_offset() -> None:
    angles, desired = BEGIN.copy(), AR2.pose(BEGIN)
    desired[:3, 3] += (0.03, 0.02, -0.02)
    desired[:3, :3] = turned((1.0, 2.0, -1.0), 0.6) @ desired[:3, :3]
    for tick in range(500):
        actual = AR2.pose(angles)
        wanted = pose_law(desired, actual, np.zeros(6), (5.0, 2.0))
        angles += STEP * resolved(AR2, angles, wanted).joints
        if tick == 100:
            assert np.linalg.norm((desired - actual)[:3, 3]) < 0.001
    error = desired[:3, :3].T @ AR2.pose(angles)[:3, :3]
    assert math.acos(min(1.0, (np.trace(error) - 1.0) / 2.0)) < 1e-3


def test_a_large_orientation_error_dies_away_by_its_gain_while_both_frames_turn() -> None:
    rng, step = np.random.default_rng(5), 1e-6

    def error(actual: Matrix, desired: Matrix) -> Matrix:
        found: Matrix = 0.5 * np.cross(actual.T, desired.T).sum(axis=0)
        return found

    for _ in range(20):
        one, two, rate = rng.normal(size=(3, 3))
        actual, desired = np.eye(4), np.eye(4)
        actual[:3, :3] = turned(tuple(one), 1.0)
        desired[:3, :3] = turned(tuple(two), 1.0) @ actual[:3, :3]
        turn = pose_law(desired, actual, np.r_[np.zeros(3), rate], (1.0, 3.0))[3:]
        after = error(
            turned(tuple(turn), step * float(np.linalg.norm(turn))) @ actual[:3, :3],
            turned(tuple(rate), step * float(np.linalg.norm(rate))) @ desired[:3, :3],
        )
        first = error(actual[:3, :3], desired[:3, :3])
        assert (after - first) / step == pytest.approx(-3.0 * first, abs=1e-4)


def test_a_turning_desired_frame_is_followed_by_its_own_turn_rate() -> None:
    axis, rate, angles = (0.0, 1.0, 1.0), 0.2, BEGIN.copy()
    begin = AR2.pose(BEGIN)
    twist = np.r_[np.zeros(3), rate * np.array(axis) / math.sqrt(2.0)]
    worst = 0.0
    for tick in range(200):
        desired = begin.copy()
        desired[:3, :3] = turned(axis, rate * tick * STEP) @ begin[:3, :3]
        actual = AR2.pose(angles)
        worst = max(worst, float(np.abs(desired - actual).max()))
        angles += STEP * resolved(AR2, angles, pose_law(desired, actual, twist, (5.0, 2.0))).joints
    assert worst < 5e-4  # without the desired turn rate 0.2 / 2.0


@every(
    ("height", "rate"),
    [
        (lambda t: 0.08 / 60.0 * t, lambda _: 0.08 / 60.0),
        (
            lambda t: 0.08 * math.sin(math.tau * t / 60.0),
            lambda t: 0.08 * math.tau / 60.0 * math.cos(math.tau * t / 60.0),
        ),
    ],
    ids=lambda _: "path",
)
def test_ramp_and_sine_with_three_joints_keep_the_tool_level(
    height: Callable[[float], float], rate: Callable[[float], float]
) -> None:
    angles = np.radians((0.0, -60.0, 70.0, 0.0, 30.0, 0.0))
    begin = AR2.pose(angles)
    for tick in range(1, 301):
        before = 0.2 * (tick - 1)
        actual = AR2.pose(angles)
        error = np.array((begin[0, 3] - actual[0, 3], begin[2, 3] + height(before) - actual[2, 3], 0.0))
        wanted = np.array((0.0, rate(before), 0.0)) + 2.0 * error
        angles += 0.2 * resolved(AR2, angles, wanted, rows=PLANAR, moving=THREE).joints
        after = AR2.pose(angles)
        assert after[2, 3] - begin[2, 3] == pytest.approx(height(0.2 * tick), abs=3e-4)
        assert after[:3, :3] == pytest.approx(begin[:3, :3], abs=1e-9)
        assert angles[[0, 3, 5]] == pytest.approx((0.0, 0.0, 0.0))


def test_through_a_straight_wrist_the_joints_go_without_a_jump_and_say_so() -> None:
    angles = np.radians((0.0, -60.0, 70.0, 0.0, 5.0, 0.0))
    twist = np.array((0.0, 0.02, 0.0, 0.0, -0.2, 0.0))  # sideways, and the fifth joint through 0
    rates, least, lowest, fastest, undamped = [], 1.0, 1.0, 0.0, 0.0
    for _ in range(100):
        found = resolved(AR2, angles, twist)
        rates.append(found.joints)
        least = min(least, found.watch.smallest)
        lowest = min(lowest, found.watch.manipulability)
        fastest = max(fastest, float(np.abs(found.joints).max()))
        undamped = max(undamped, float(np.abs(np.linalg.pinv(AR2.jacobian(angles)) @ twist).max()))
        angles += STEP * found.joints
    assert least < 0.02
    assert lowest < 1e-3
    assert fastest < np.linalg.norm(twist) / Damping().below
    assert np.abs(np.diff(rates, axis=0)).max() < 0.15
    assert undamped > 3.0 * fastest


def test_damping_begins_smoothly_and_far_away_there_is_none() -> None:
    damping = Damping()
    assert damping.squared(0.5) == damping.squared(0.03) == 0.0
    assert damping.squared(0.03 - 1e-9) < 1e-9
    assert damping.squared(0.0) == pytest.approx(9e-4)
    free = resolved(AR2, BEGIN, np.array((0.01, 0.02, 0.0, 0.1, 0.0, 0.0)))
    assert free.watch.damping == 0.0
    assert AR2.jacobian(BEGIN) @ free.joints == pytest.approx((0.01, 0.02, 0.0, 0.1, 0.0, 0.0))


def test_a_stretched_arm_that_is_pulled_on_stands() -> None:
    angles = np.radians((0.0, -40.0, 3.0, 0.0, 10.0, 0.0))
    outwards = np.array((math.cos(math.radians(40.0)), 0.0, math.sin(math.radians(40.0))))
    rates = []
    for _ in range(400):
        found = resolved(AR2, angles, 0.02 * outwards, rows=POSITION)
        rates.append(np.abs(found.joints).max())
        angles += 2.0 * STEP * found.joints
    assert max(rates) < 0.02 / 0.03
    assert np.abs(np.diff(rates)).max() < 0.2


def test_a_joint_near_its_limit_leaves_the_work_to_the_others() -> None:
    angles = BEGIN.copy()
    wanted = np.array((0.0, 0.05, 0.0))
    free = resolved(AR2, angles, wanted, rows=POSITION).joints
    angles[0] = AR2.most[0] - 0.02
    sideways = turned((0.0, 0.0, 1.0), angles[0] - BEGIN[0]) @ wanted
    near = resolved(AR2, angles, sideways, rows=POSITION).joints
    assert free[0] > 0.05
    assert 0.0 <= near[0] < 0.2 * free[0]
    assert AR2.jacobian(angles)[:3] @ near == pytest.approx(sideways, abs=1e-9)
    away = resolved(AR2, angles, -sideways, rows=POSITION).joints
    assert away[0] == pytest.approx(-free[0], rel=0.01)  # the others weigh otherwise on this side


def test_all_joints_are_slowed_by_one_share() -> None:
    fastest = (1.0,) * 6
    assert slowed(AR2, BEGIN, np.zeros(6), fastest, 0.1) == 1.0
    assert slowed(AR2, BEGIN, np.array((0.5, -4.0, 0.0, 0.0, 0.0, 2.0)), fastest, 0.1) == 0.25
    at = list(BEGIN)
    at[2] = AR2.most[2] - 0.03
    rates = np.array((0.0, 0.0, 0.6, 0.0, 0.0, 0.0))
    assert slowed(AR2, at, rates, fastest, 0.1) == pytest.approx(0.5)
    assert slowed(AR2, at, rates, fastest, 0.1, margin=0.03) == pytest.approx(0.0, abs=1e-9)
    assert slowed(AR2, at, -rates, fastest, 0.1, margin=0.03) == 1.0
    at[2] = AR2.most[2] + 0.1
    assert slowed(AR2, at, rates, fastest, 0.1) == 0.0


def test_what_is_requested_are_all_six_unless_rows_are_named() -> None:
    assert tuple(range(6)) == ALL
