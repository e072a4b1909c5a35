"""The arm's postures at special places: above the shoulder, a turn away, too near, with a folded wrist."""

import math

import numpy as np
import pytest

from firmware_bridge.motion.chain import Matrix
from firmware_bridge.robots.ar2.arm import AR2, flips_wrist, postures
from hil_tests.rows import every

BASE = (100.0, -70.0, 60.0, 40.0, 30.0, 30.0)
"""Degrees of the joints, all off the middle of their limits."""


@every(("fifth", "flips"), [(-30.0, False), (-0.1, False), (0.0, False), (0.1, True), (30.0, True)])
@every("others", [50.0, -50.0])
def test_the_wrist_flips_where_the_fifth_joint_is_positive(
    fifth: float, others: float, *, flips: bool
) -> None:
    angles = [math.radians(it) for it in (others, others, others, others, fifth, others)]
    assert flips_wrist(angles) is flips


@every(("joint", "turns"), [(joint, turns) for joint in range(6) for turns in (-2, -1, 0, 1, 2)])
def test_a_posture_that_is_near_by_whole_turns_is_in_the_limits(joint: int, turns: int) -> None:
    angles = np.radians(BASE)
    near = angles.copy()
    near[joint] += turns * math.tau
    found = postures(AR2.pose(angles), near)
    assert any(each == pytest.approx(angles, abs=1e-9) for each in found)


@every("degrees", [BASE, (-20.0, -100.0, 30.0, -50.0, -40.0, 70.0), (0.0, -60.0, 90.0, 100.0, 5.0, 0.0)])
def test_each_posture_is_found_once(degrees: tuple[float, ...]) -> None:
    found = postures(AR2.pose(np.radians(degrees)), np.radians(degrees))
    for place, each in enumerate(found):
        for other in found[:place]:
            assert np.abs(np.subtract(each, other)).max() > 0.01


def downwards(x: float, y: float) -> Matrix:
    """Return a pose of the tool that looks down; the wrist's point is above the shoulder, but for x and y."""
    pose = np.diag((1.0, -1.0, -1.0, 1.0))
    pose[:3, 3] = (x, y, 0.65 + 0.03625)
    return pose


@every(
    ("x", "y", "first"),
    [
        (0.0, 0.0, 35.0),
        (0.9e-9, 0.0, 35.0),
        (1e-9, 0.0, 35.0),
        (1.005e-9, 0.0, 0.0),
        (0.0, 1e-9, 35.0),
        (0.0, 1.005e-9, 90.0),
    ],
)
def test_nearer_to_the_first_axis_than_a_nanometer_its_joint_stays(x: float, y: float, first: float) -> None:
    pose = downwards(x, y)
    found = postures(pose, np.radians((35.0, -90.0, 60.0, 10.0, 20.0, 30.0)))
    assert math.degrees(found[0][0]) == pytest.approx(first)
    assert all(AR2.pose(each) == pytest.approx(pose, abs=1e-8) for each in found)


@every("off", [0.0, 0.01, 0.05, 0.08])
def test_nearer_to_the_shoulder_than_the_difference_of_both_arms_there_is_no_posture(off: float) -> None:
    """305 less 222.63 mm; turned from it the wrist's point is too near, too, for an elbow of 141 degrees."""
    pose = np.eye(4)
    pose[:3, 3] = (0.0642 + off, 0.0, 0.16977 - 0.03625)
    assert postures(pose, [0.0] * 6) == []


@every(("fourth", "sixth"), [(fourth, sixth) for fourth in (-30.0, 30.0) for sixth in (-120.0, 20.0, 120.0)])
def test_a_folded_wrist_is_out_of_its_limits_and_taken_for_no_other(fourth: float, sixth: float) -> None:
    angles = np.radians((20.0, -70.0, 60.0, fourth, 180.0, sixth))
    pose = AR2.pose(angles)
    for each in postures(pose, angles):
        assert AR2.reaches(each)
        assert AR2.pose(each) == pytest.approx(pose, abs=1e-9)
