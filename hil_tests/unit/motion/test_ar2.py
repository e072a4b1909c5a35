"""The arm's kinematics: published poses, its Jacobian by differences, and back from poses to postures."""

import math
from itertools import pairwise

import numpy as np
import pytest

from emulators.arduino_omni.ar2.axes import JOINTS
from emulators.arduino_omni.ar2.gravity import LINKS, weight
from firmware_bridge.motion.chain import Matrix, nearest_turn, roll_pitch_yaw
from firmware_bridge.robots.ar2.arm import AR2, flips_wrist, postures
from hil_tests.rows import every


def radians(*degrees: float) -> list[float]:
    return [math.radians(it) for it in degrees]


@every(
    ("degrees", "place_mm"),
    [
        ((0, 0, 0, 0, 0, 0), (628.08, 0, 169.77)),
        ((0, -90, 1.03, 0, 0, 0), (68.854, 0, 733.608)),
        ((-0.02, -90.01, 90.01, 0.0001, 89.9, 0.02), (286.84, -0.10, 438.52)),  # stored by ROME
        ((30, -60, 45, 10, 20, -30), (406.21, 232.039, 488.551)),
    ],
)
def test_the_tool_is_where_it_is_published(degrees: tuple[float, ...], place_mm: tuple[float, ...]) -> None:
    place = 1000.0 * AR2.pose(radians(*degrees))[:3, 3]
    assert place == pytest.approx(place_mm, abs=0.006)


def test_limits_are_those_of_the_board() -> None:
    assert np.degrees(AR2.least) == pytest.approx([axis.least_deg for axis in JOINTS])
    assert np.degrees(AR2.most) == pytest.approx([axis.most_deg for axis in JOINTS])
    inside = radians(0, -90, 1.03, 0, 0, 0)
    assert AR2.reaches(inside)
    assert not AR2.reaches(inside, margin=0.001)
    assert not AR2.reaches(radians(0, -90, 0.9, 0, 0, 0))


def test_the_jacobian_is_what_small_turns_do() -> None:
    rng, step = np.random.default_rng(1), 1e-6
    for _ in range(20):
        angles = rng.uniform(AR2.least, AR2.most)
        jacobian = AR2.jacobian(angles)
        for joint in range(6):
            turned = step * np.eye(6)[joint]
            before, after = AR2.pose(angles - turned), AR2.pose(angles + turned)
            speed = (after - before)[:3, 3] / (2.0 * step)
            spin = (after - before)[:3, :3] @ AR2.pose(angles)[:3, :3].T / (2.0 * step)
            assert jacobian[:3, joint] == pytest.approx(speed, abs=1e-9)
            assert jacobian[3:, joint] == pytest.approx((spin[2, 1], spin[0, 2], spin[1, 0]), abs=1e-9)


def test_the_emulated_arms_weight_is_the_slope_of_its_potential_energy() -> None:
    def energy(angles: Matrix) -> float:
        heights = [frame[2, 3] for frame in AR2.frames(angles)]
        middles = [(one + two) / 2.0 for one, two in pairwise(heights)]
        return float(sum(9.81 * link[4] * height for link, height in zip(LINKS, middles, strict=True)))

    rng, step = np.random.default_rng(2), 1e-6
    for _ in range(20):
        angles = rng.uniform(AR2.least, AR2.most)
        slopes = [
            (energy(angles + step * row) - energy(angles - step * row)) / (2.0 * step) for row in np.eye(6)
        ]
        assert weight(np.degrees(angles).tolist()) == pytest.approx(slopes, abs=1e-7)


def there_and_back(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(count):
        angles = rng.uniform(AR2.least, AR2.most)
        pose = AR2.pose(angles)
        found = postures(pose, angles)
        assert found[0] == pytest.approx(angles, abs=1e-6)
        for each in found:
            assert AR2.reaches(each)
            assert np.abs(AR2.pose(each) - pose).max() < 1e-9


def test_some_hundred_poses_lead_back_to_their_postures() -> None:
    there_and_back(300, 3)


@pytest.mark.long(beside="test_some_hundred_poses_lead_back_to_their_postures")
def test_a_hundred_thousand_poses_lead_back_to_their_postures() -> None:
    there_and_back(100_000, 4)


@every("fourth", [-150.0, 0.0, 40.0])
def test_a_straight_wrist_keeps_its_fourth_joint(fourth: float) -> None:
    angles = radians(20, -70, 60, fourth, 0, 30)
    (found, *_) = postures(AR2.pose(angles), angles)
    assert found == pytest.approx(angles, abs=1e-9)


def test_above_its_shoulder_the_first_joint_stays() -> None:
    angles = radians(35, -100, 60, 10, 20, 30)
    pose = AR2.pose(angles)
    pose[:3, 3] = (0.0, 0.0, 0.6) + -0.03625 * pose[:3, 2]
    found = postures(pose, angles)
    assert found
    assert all(AR2.pose(each) == pytest.approx(pose, abs=1e-9) for each in found)


def test_out_of_reach_and_out_of_limits_there_is_no_posture() -> None:
    pose = AR2.pose([0.0] * 6)
    pose[0, 3] += 0.01
    assert postures(pose, [0.0] * 6) == []
    low = AR2.pose(radians(0, 30, 90, 0, 0, 0))
    assert all(AR2.reaches(each) for each in postures(low, [0.0] * 6))


def test_the_wrists_two_postures_have_their_letters() -> None:
    angles = radians(20, -70, 60, 40, 30, 30)
    letters = {flips_wrist(each) for each in postures(AR2.pose(angles), angles)}
    assert letters == {True, False}
    assert nearest_turn(7.0, 0.0) == pytest.approx(7.0 - math.tau)


def test_angles_about_the_axes_are_those_that_turn_the_frame() -> None:
    def about(axis: int, angle: float) -> Matrix:
        c, s = math.cos(angle), math.sin(angle)
        one, two = (axis + 1) % 3, (axis + 2) % 3
        turned = np.eye(4)
        turned[one, one], turned[one, two], turned[two, one], turned[two, two] = c, -s, s, c
        return turned

    pose = about(2, 0.7) @ about(1, -0.4) @ about(0, 2.0)
    assert roll_pitch_yaw(pose) == pytest.approx((2.0, -0.4, 0.7))


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("upper", [True, False])
def test_a_margin_counts_at_both_ends_of_each_joint(joint: int, *, upper: bool) -> None:
    angles = [(low + high) / 2.0 for low, high in zip(AR2.least, AR2.most, strict=True)]
    for inside, good in ((0.02, True), (0.005, False), (-0.005, False)):
        angles[joint] = AR2.most[joint] - inside if upper else AR2.least[joint] + inside
        assert AR2.reaches(np.array(angles), margin=0.01) is good
