"""The robot's path follower: it drives a figure of eight by the pose, two circles that touch where it begins.

It gives commands, as a stick does: interlocks, limits and ramp stand between it and the wheels.
"""

import math
from typing import Final

from firmware_bridge.differential.geometry import Geometry
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import Nanoseconds

from diff_drive.motion import Motion, State

FIGURE_EIGHT: Final = "figure_eight"
RADIUS_M: Final = 1.0
SPEED_SHARE: Final = 0.5
"""Of the speed limit."""
CORRECTION_PER_M: Final = 2.0
"""Reciprocal of the way on which a deviation from the circle is made good."""


class FigureEight:
    """A `firmware_bridge.robot_type.PathFollower`: a circle to the left, one to the right, repeated."""

    __slots__ = ("_angle", "_side", "_speed", "_start", "_swept")

    def __init__(self, robot: Robot[Geometry]) -> None:
        limits = robot.geometry.limits
        self._speed = SPEED_SHARE * min(limits.speed_mps, limits.turn_rate_rad_s * RADIUS_M)
        self.reset()

    def reset(self) -> None:
        """Begin again, where the robot stands then."""
        self._start: Pose | None = None
        self._side = 1.0
        self._angle = 0.0
        self._swept = 0.0

    def command(self, seen: Snapshot[Motion, State], _elapsed: Nanoseconds) -> Motion:
        """Return the speed and turn rate that keep to the circle, and come back to it."""
        start = self._start = self._start or seen.pose
        ahead, left = self._from_center(seen.pose, start)
        angle = math.atan2(ahead, -self._side * left)
        self._swept += _wrapped(angle - self._angle)
        self._angle = angle
        if self._swept >= 2.0 * math.pi:
            # Back where the circles touch: on with the other one, whose center lies across.
            self._side, self._swept, self._angle = -self._side, 0.0, 0.0
            ahead, left = self._from_center(seen.pose, start)
            angle = self._angle = math.atan2(ahead, -self._side * left)
        outside = math.hypot(ahead, left) - RADIUS_M
        askew = _wrapped(self._side * (seen.pose.heading_rad - start.heading_rad) - angle)
        bend = 1.0 / RADIUS_M + CORRECTION_PER_M**2 * outside - 2.0 * CORRECTION_PER_M * math.sin(askew)
        return Motion(self._speed, self._side * self._speed * bend, lamp=True)

    def _from_center(self, pose: Pose, start: Pose) -> tuple[float, float]:
        """Return how far the robot is ahead and left of the circle's center, as it looked at the start."""
        x, y = pose.x_m - start.x_m, pose.y_m - start.y_m
        sine, cosine = math.sin(start.heading_rad), math.cos(start.heading_rad)
        return x * cosine + y * sine, y * cosine - x * sine - self._side * RADIUS_M


def _wrapped(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)
