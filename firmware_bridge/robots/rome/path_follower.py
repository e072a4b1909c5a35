"""ROME's path followers: the control law (2.15) along a path. They give commands, which the gate judges.

V = P(psi) (chi_d' - K_p e - K_i int e), with e = actual - desired (A. Seleit, MSc thesis, UCF, 2020). (2.17)
has other signs, and diverges as it is printed. P is the body's; here it is a motion in the base's own frame.

The path begins where the base stands: it is moved and turned there. While the base is held back the path
waits, and the integral is forgotten; it is not added to while a rim is at its limit. Where cameras see the
base the pose is theirs; before they have seen it nothing is commanded.
"""

import math
from typing import Final

from firmware_bridge.motion.captured import Source
from firmware_bridge.motion.omni import BodyTwist, rims
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rome.geometry import RomeGeometry
from firmware_bridge.robots.rome.motion import RomeMotion, RomeState
from firmware_bridge.robots.rome.paths import PATHS, Path
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import Nanoseconds, to_seconds


class RomePathFollower:
    """A `firmware_bridge.robot_type.PathFollower` along one path."""

    def __init__(self, robot: Robot[RomeGeometry], path: Path) -> None:
        geometry = robot.geometry
        self._path: Final = path
        self._control: Final = geometry.control
        self._distance: Final = geometry.base.wheel_distance_m
        self._rim: Final = geometry.limits.rim_mps
        self._axes: Final = tuple(axis.name for axis in robot.axes)
        self._start: Pose | None = None
        self._seconds = 0.0
        self._waits = False
        self._posed_at: Nanoseconds | None = None
        """Time of the samples whose pose comes next."""
        self._sum = (0.0, 0.0, 0.0)

    def reset(self) -> None:
        """Forget the integral, and let the path wait: the base was held back."""
        self._sum, self._waits = (0.0, 0.0, 0.0), True

    def command(self, seen: Snapshot[RomeMotion, RomeState], elapsed: Nanoseconds) -> RomeMotion:
        """Return the motion towards where the path is now."""
        pose = seen.pose
        if seen.located is not None and seen.located.source is Source.UNSEEN:
            return RomeMotion(path_s=self._seconds)
        if self._start is None:
            self._start = pose
        elif not self._waits:
            self._seconds += to_seconds(elapsed)
        self._waits = False
        seconds = self._seconds
        # The pose is carried on behind this: it is that of the samples before, of that instant.
        sampled = min(seen.facts.axes[name].sampled_at for name in self._axes)
        age = seen.facts.now - (sampled if self._posed_at is None else self._posed_at)
        self._posed_at = sampled
        error = self._error(pose, self._start, seconds - to_seconds(age))
        ahead = self._path(seconds)
        feed = _turned((ahead.x_rate, ahead.y_rate), self._start.heading_rad)
        added = tuple(it + one * to_seconds(elapsed) for it, one in zip(self._sum, error, strict=True))
        command = self._law((*feed, ahead.turn_rate), error, added, pose.heading_rad)
        # An integral that grows while a rim is at its limit would overshoot afterwards (wind-up).
        if max(map(abs, rims(command, self._distance))) <= self._rim:
            self._sum = (added[0], added[1], added[2])
        return RomeMotion(command.ahead, command.left, command.turn, path_s=seconds)

    def _error(self, pose: Pose, start: Pose, seconds: float) -> tuple[float, float, float]:
        first, place = self._path(0.0), self._path(seconds)
        x, y = _turned((place.x - first.x, place.y - first.y), start.heading_rad)
        heading = start.heading_rad + place.heading - first.heading
        return (
            pose.x_m - start.x_m - x,
            pose.y_m - start.y_m - y,
            math.remainder(pose.heading_rad - heading, math.tau),
        )

    def _law(
        self,
        feed: tuple[float, ...],
        error: tuple[float, ...],
        added: tuple[float, ...],
        heading: float,
    ) -> BodyTwist:
        kp, ki = self._control.kp_per_s, self._control.ki_per_s2
        x, y, turn = (
            rate - kp * one - ki * total for rate, one, total in zip(feed, error, added, strict=True)
        )
        # The law is in the room's axes; the base is commanded in its own.
        return BodyTwist(*_turned((x, y), -heading), turn)


def named(robot: Robot[RomeGeometry], name: str) -> RomePathFollower:
    """Return the path follower along one of the paths of the robot's file."""
    return RomePathFollower(robot, PATHS[name](robot.geometry.paths))


def _turned(way: tuple[float, float], angle: float) -> tuple[float, float]:
    sine, cosine = math.sin(angle), math.cos(angle)
    return way[0] * cosine - way[1] * sine, way[0] * sine + way[1] * cosine
