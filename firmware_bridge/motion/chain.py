"""A chain of turning joints: where its frames are, and how its end moves with each of them.

Source: Denavit and Hartenberg's standard form, T = Rz(theta + offset) Tz(d) Tx(a) Rx(alpha), with the element
(1, 2) of A. Seleit, MSc thesis, UCF, 2020, (3.1), as it must be: -sin(theta) cos(alpha). Angles in rad,
lengths in m.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

Matrix: TypeAlias = NDArray[np.float64]
Angles: TypeAlias = Sequence[float] | Matrix


class ChainLink(NamedTuple):
    """One joint and what it carries."""

    alpha: float
    a: float
    d: float
    offset: float = 0.0

    def transform(self, theta: float) -> Matrix:
        """Return the 4 x 4 matrix from this link's frame to the one before, at an angle of its joint."""
        sine, cosine = math.sin(theta + self.offset), math.cos(theta + self.offset)
        twisted, straight = math.sin(self.alpha), math.cos(self.alpha)
        return np.array(
            [
                [cosine, -sine * straight, sine * twisted, self.a * cosine],
                [sine, cosine * straight, -cosine * twisted, self.a * sine],
                [0.0, twisted, straight, self.d],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )


@dataclass(frozen=True, slots=True)
class Chain:
    """Links from the floor to the tool, and how far each joint goes, in rad."""

    links: tuple[ChainLink, ...]
    least: tuple[float, ...]
    most: tuple[float, ...]

    def frames(self, angles: Angles) -> list[Matrix]:
        """Return the frames from the floor's to the tool's, one more than there are joints."""
        found: list[Matrix] = [np.eye(4)]
        for link, angle in zip(self.links, angles, strict=True):
            found.append(found[-1] @ link.transform(angle))
        return found

    def pose(self, angles: Angles) -> Matrix:
        """Return the tool's frame in the floor's, 4 x 4."""
        return self.frames(angles)[-1]

    def jacobian(self, angles: Angles) -> Matrix:
        """Return how the tool moves with each joint, in the floor's frame: m/s above rad/s, 6 x n."""
        frames = np.array(self.frames(angles))
        # A turning joint moves the tool with its axis times the lever, and turns it about its axis.
        axes, levers = frames[:-1, :3, 2], frames[-1, :3, 3] - frames[:-1, :3, 3]
        return np.hstack((np.cross(axes, levers), axes)).T

    def reaches(self, angles: Angles, margin: float = 0.0) -> bool:
        """Return whether all joints are in their limits, and by a margin in rad."""
        return all(
            low + margin <= it <= high - margin
            for low, it, high in zip(self.least, angles, self.most, strict=True)
        )


def roll_pitch_yaw(pose: Matrix) -> tuple[float, float, float]:
    """Return the angles about x, y and z, in rad, that turn the floor's frame into the tool's, z last.

    Source: (3.6) with yaw = atan2(T21, T11), and the names about x and z in their right places.
    """
    return (
        math.atan2(pose[2, 1], pose[2, 2]),
        math.atan2(-pose[2, 0], math.hypot(pose[2, 1], pose[2, 2])),
        math.atan2(pose[1, 0], pose[0, 0]),
    )


TURN: Final = math.tau


def nearest_turn(angle: float, to: float) -> float:
    """Return the angle, turned by whole turns so that it is nearest to another one."""
    return angle - TURN * round((angle - to) / TURN)
