"""Where the robot is, from the counts of its two rear wheels; it knows no drive and no bus.

The thesis advances the pose by forward Euler every 50 ms (4.13)-(4.15): its largest error on a closed circle
is v dt, because each step runs along the old heading. Here each step is the exact arc of two wheels that
roll with constant speed and do not slip, so a circle closes whatever the cycle.
"""

import math
from dataclasses import dataclass
from typing import Final

from firmware_bridge.robot import Axis, Robot, Role

_COUNTER_SPAN: Final = 1 << 32
_COUNTER_HALF: Final = 1 << 31
_STRAIGHT_RAD: Final = 1e-6
"""Below this turn a step is a straight line; the arc then differs by less than 1e-12 of its length."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Middle of the rear axle: x forward and y left of the start, heading counter-clockwise, not wrapped."""

    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0


def moved(pose: Pose, left_m: float, right_m: float, track_m: float) -> Pose:
    """Return the pose after the two rear wheels rolled these lengths, exact for constant speeds."""
    length = (left_m + right_m) / 2.0
    turn = (right_m - left_m) / track_m
    half = turn / 2.0
    chord = length if abs(turn) < _STRAIGHT_RAD else length * math.sin(half) / half
    course = pose.heading_rad + half
    return Pose(
        pose.x_m + chord * math.cos(course),
        pose.y_m + chord * math.sin(course),
        pose.heading_rad + turn,
    )


def counted(earlier_qc: int, later_qc: int) -> int:
    """Return the quadcounts from one 32-bit counter reading to the next, across its wrap-around.

    Right for any move below 2**31 counts, 13 km of a RARS wheel.
    """
    return (later_qc - earlier_qc + _COUNTER_HALF) % _COUNTER_SPAN - _COUNTER_HALF


class Odometry:
    """Pose from the position counters of the two rear wheels."""

    __slots__ = ("_counts", "_left_m", "_pose", "_right_m", "_track_m")

    def __init__(self, robot: Robot) -> None:
        self._left_m = _metres_per_count(robot, robot.axis(Role.LEFT_WHEEL))
        self._right_m = _metres_per_count(robot, robot.axis(Role.RIGHT_WHEEL))
        self._track_m = robot.base.rear_track_m
        self._pose = Pose()
        self._counts: tuple[int, int] | None = None

    @property
    def pose(self) -> Pose:
        """The pose at the newest counts."""
        return self._pose

    def advance(self, left_qc: int, right_qc: int) -> Pose:
        """Take two counters read at one SYNC; the first pair only says where counting starts."""
        if self._counts is not None:
            self._pose = moved(
                self._pose,
                counted(self._counts[0], left_qc) * self._left_m,
                counted(self._counts[1], right_qc) * self._right_m,
                self._track_m,
            )
        self._counts = (left_qc, right_qc)
        return self._pose

    def reset(self) -> None:
        """Make the present place the origin."""
        self._pose = Pose()

    def rebase(self) -> None:
        """Forget the counters, not the pose: the next pair is a new start, as after a drive's reset."""
        self._counts = None


def _metres_per_count(robot: Robot, axis: Axis) -> float:
    return robot.base.wheel_radius_m / axis.quadcounts_per_radian
