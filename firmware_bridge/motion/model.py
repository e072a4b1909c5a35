"""A robot's response to a commanded speed and yaw rate: the model that a predictor integrates."""

import math
from dataclasses import dataclass
from typing import Protocol

from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose


@dataclass(frozen=True, slots=True)
class Moving:
    """Pose and motion of a robot: m/s, rad/s."""

    pose: Pose
    speed_mps: float = 0.0
    yaw_rate_rad_s: float = 0.0
    steer_rad: float | None = None
    """Steering angle of one that steers; None: by its turn."""


class MotionModel(Protocol):
    """One robot's motion."""

    @property
    def tightest_per_m(self) -> float:
        """The largest curvature that it can drive."""

    def step(self, moving: Moving, speed_mps: float, yaw_rate_rad_s: float, seconds: float) -> Moving:
        """Return its motion after some time of these set-points."""


class Unicycle:
    """A robot that follows its set-points at once."""

    tightest_per_m = math.inf

    def step(self, moving: Moving, speed_mps: float, yaw_rate_rad_s: float, seconds: float) -> Moving:
        """Return its motion after some time of these set-points."""
        return Moving(arc(moving.pose, speed_mps, yaw_rate_rad_s, seconds), speed_mps, yaw_rate_rad_s)


def arc(pose: Pose, speed_mps: float, yaw_rate_rad_s: float, seconds: float) -> Pose:
    """Return the pose at the end of an arc."""
    length, half = speed_mps * seconds, yaw_rate_rad_s * seconds / 2.0
    return moved(pose, length - half, length + half, 1.0)
