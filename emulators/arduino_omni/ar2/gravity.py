"""Joint torques from the arm's own weight.

It shares nothing with the bridge's kinematics, so that a fault in one shows beside the other.

Source: public values of the AR2/AR3 family for the links' lengths, in Denavit and Hartenberg's form.

Where it is silent:
* links of 3.5, 2.5, 2.0, 1.0, 0.5 and 0.3 kg, each in the middle between its frame and the one before.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

GRAVITY: Final = 9.81
LINKS: Final[tuple[tuple[float, float, float, float, float], ...]] = (
    (-90.0, 0.0642, 0.16977, 0.0, 3.5),
    (0.0, 0.305, 0.0, 0.0, 2.5),
    (90.0, 0.0, 0.0, -90.0, 2.0),
    (-90.0, 0.0, -0.22263, 0.0, 1.0),
    (90.0, 0.0, 0.0, 0.0, 0.5),
    (0.0, 0.0, -0.03625, 180.0, 0.3),
)
"""Data of each joint: alpha in degrees, a and d in m, its angle's offset in degrees, link mass in kg."""
Vector = tuple[float, float, float]


def weight(angles_deg: Sequence[float]) -> tuple[float, ...]:
    """Return by how much the potential energy grows with each joint's angle, in N m.

    A joint that turns against its sign is helped by the weight.
    """
    origins: list[Vector] = [(0.0, 0.0, 0.0)]
    axes: list[Vector] = [(0.0, 0.0, 1.0)]
    along: Vector = (1.0, 0.0, 0.0)
    for (alpha, a, d, offset, _), angle in zip(LINKS, angles_deg, strict=True):
        axis, before = axes[-1], origins[-1]
        turn, twist = math.radians(angle + offset), math.radians(alpha)
        left = _cross(axis, along)
        along = _sum(math.cos(turn), along, math.sin(turn), left)
        origins.append(_plus(before, _sum(a, along, d, axis)))
        axes.append(_sum(math.cos(twist), axis, math.sin(twist), _cross(along, axis)))
    middles = [_sum(0.5, one, 0.5, two) for one, two in pairwise(origins)]
    # Each joint carries the links behind it only.
    return tuple(
        sum(
            LINKS[link][4] * GRAVITY * _rise(axes[joint], origins[joint], middles[link])
            for link in range(joint, len(LINKS))
        )
        for joint in range(len(LINKS))
    )


def _rise(axis: Vector, origin: Vector, point: Vector) -> float:
    """Return how fast a point rises for 1 rad/s about an axis."""
    return axis[0] * (point[1] - origin[1]) - axis[1] * (point[0] - origin[0])


def _cross(one: Vector, two: Vector) -> Vector:
    """Return the vector product `one` x `two`."""
    return (
        one[1] * two[2] - one[2] * two[1],
        one[2] * two[0] - one[0] * two[2],
        one[0] * two[1] - one[1] * two[0],
    )


def _sum(first: float, one: Vector, second: float, two: Vector) -> Vector:
    return (
        first * one[0] + second * two[0],
        first * one[1] + second * two[1],
        first * one[2] + second * two[2],
    )


def _plus(one: Vector, two: Vector) -> Vector:
    return _sum(1.0, one, 1.0, two)
