"""The arm AR2: its links, and all its postures for a pose of the tool, in closed form.

Its shoulder, elbow and wrist lie in one upright plane, and the last three axes meet in one point, so the
wrist's point gives the first three joints, and what is left to turn the last three.

Source: public values of the AR2/AR3 family (Annin Robotics), as ROME has them: lengths in m, angles in rad.
"""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from firmware_bridge.motion.chain import Angles, Chain, ChainLink, Matrix, nearest_turn

_QUARTER: Final = math.pi / 2.0
UPPER_ARM_M: Final = 0.305
FOREARM_M: Final = 0.22263
SHOULDER_M: Final = 0.0642
HEIGHT_M: Final = 0.16977
TOOL_M: Final = -0.03625
AR2: Final = Chain(
    (
        ChainLink(-_QUARTER, SHOULDER_M, HEIGHT_M),
        ChainLink(0.0, UPPER_ARM_M, 0.0),
        ChainLink(_QUARTER, 0.0, 0.0, -_QUARTER),
        ChainLink(-_QUARTER, 0.0, -FOREARM_M),
        ChainLink(_QUARTER, 0.0, 0.0),
        ChainLink(0.0, 0.0, TOOL_M, math.pi),
    ),
    tuple(map(math.radians, (-170.0, -132.0, 1.0, -165.0, -105.0, -155.0))),
    tuple(map(math.radians, (170.0, 0.0, 141.0, 165.0, 105.0, 155.0))),
)
STRAIGHT: Final = 1e-9
"""Below this sine of the fifth joint the fourth and sixth turn about one axis."""


def flips_wrist(angles: Angles) -> bool:
    """Return which of the wrist's two postures it is, `$F` in the GUI's programs, and else `$N`."""
    return angles[4] > 0.0


def postures(pose: Matrix, near: Angles) -> list[tuple[float, ...]]:
    """Return the joints' angles that bring the tool to a pose, in their limits, the nearest to `near` first.

    None where it is out of reach. Where the wrist is straight, the fourth joint stays as in `near`.
    """
    found = [
        tuple(nearest_turn(angle, to) for angle, to in zip((*arm, *wrist), near, strict=True))
        # Back along the tool's axis to the point in which the wrist's three axes meet.
        for arm in _arms(pose[:3, 3] - TOOL_M * pose[:3, 2], near[0])
        for wrist in _wrists(arm, pose, near[3])
    ]
    return sorted(
        (each for each in map(_in_limits, found) if AR2.reaches(each)),
        key=lambda each: sum((one - two) ** 2 for one, two in zip(each, near, strict=True)),
    )


def _in_limits(angles: tuple[float, ...]) -> tuple[float, ...]:
    """Return the same posture, each joint by whole turns nearer to its middle where it is out of limits."""
    return tuple(
        angle if low <= angle <= high else nearest_turn(angle, (low + high) / 2.0)
        for low, angle, high in zip(AR2.least, angles, AR2.most, strict=True)
    )


def _arms(wrist: Matrix, near: float) -> Iterator[tuple[float, float, float]]:
    """Yield the first three joints for the wrist's point: facing it or turned from it, elbow up or down."""
    x, y, z = (float(it) for it in wrist)
    away = math.hypot(x, y)
    for side in (1.0, -1.0):
        # On the first axis every angle of it leads to the point: the present one is kept.
        turned = math.atan2(side * y, side * x) if away > STRAIGHT else near
        along, down = side * away - SHOULDER_M, HEIGHT_M - z
        # Law of cosines in the triangle of shoulder, elbow and wrist; beyond 1 the point is out of reach.
        cosine = (along**2 + down**2 - UPPER_ARM_M**2 - FOREARM_M**2) / (2.0 * UPPER_ARM_M * FOREARM_M)
        if abs(cosine) > 1.0:
            continue
        for elbow in (math.acos(cosine), -math.acos(cosine)):
            beyond = math.atan2(FOREARM_M * math.sin(elbow), UPPER_ARM_M + FOREARM_M * math.cos(elbow))
            yield turned, math.atan2(down, along) - beyond, elbow


def _wrists(
    arm: tuple[float, float, float], pose: Matrix, near: float
) -> Iterator[tuple[float, float, float]]:
    """Yield the last three joints: Rz(4) Ry(5) Rz(6 + pi) is what is left to turn."""
    before: Matrix = np.eye(3)
    for link, angle in zip(AR2.links, arm, strict=False):
        before = before @ link.transform(angle)[:3, :3]
    left = before.T @ pose[:3, :3]
    sine = math.hypot(left[0, 2], left[1, 2])
    # Joints 4 and 6 turn about one axis here, so only their sum or difference is determined.
    if sine < STRAIGHT:
        upright = left[2, 2] > 0.0
        total = math.atan2(left[1, 0], left[0, 0]) if upright else math.atan2(-left[1, 0], -left[0, 0])
        yield near, 0.0 if upright else math.pi, (total - near if upright else near - total) - math.pi
        return
    # Joint 5 to the other side, with 4 and 6 turned by half a turn, is the same orientation.
    for side in (1.0, -1.0):
        yield (
            math.atan2(side * left[1, 2], side * left[0, 2]),
            math.atan2(side * sine, left[2, 2]),
            math.atan2(side * left[2, 1], -side * left[2, 0]) - math.pi,
        )
