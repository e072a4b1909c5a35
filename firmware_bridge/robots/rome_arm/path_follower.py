"""ROME's path followers: the base's law along x, y, the arm's along z, one clock; the gate judges them."""

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any, Final

from firmware_bridge.motion.captured import Source
from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2 import path_follower as arms
from firmware_bridge.robots.ar2.geometry import Courses
from firmware_bridge.robots.rome import path_follower as bases
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.robots.rome_arm.halves import ARM, BASE, Seen
from firmware_bridge.robots.rome_arm.motion import RomeArmMotion
from firmware_bridge.robots.rome_arm.orbit import PATHS, TimedPath
from firmware_bridge.units import Nanoseconds


class Flyer:
    """A `firmware_bridge.robot_type.PathFollower` of base and arm along one path."""

    def __init__(self, robot: Robot[RomeArmGeometry], make: Callable[[RomeArmGeometry], TimedPath]) -> None:
        path = make(robot.geometry)

        def course(courses: Courses, seconds: float) -> arms.CoursePoint:
            del courses
            return path.tool(seconds)

        self._rate: Final = 1.0 / path.stretch
        self._base: Final = bases.RomePathFollower(BASE.robot(robot), path.base)
        self._arm: Final = arms.Ar2PathFollower(ARM.robot(robot), course)

    def reset(self) -> None:
        """Let the path wait: the robot was held back."""
        self._base.reset()
        self._arm.reset()

    def command(self, seen: Seen, elapsed: Nanoseconds) -> RomeArmMotion:
        """Return the motion towards where the path is now."""
        base = self._base.command(BASE.seen(seen), elapsed)
        if seen.located is not None and seen.located.source is Source.UNSEEN:
            return RomeArmMotion(base, path_rate=self._rate)
        return RomeArmMotion(base, self._arm.command(ARM.seen(seen), elapsed), self._rate)


PATH_FOLLOWERS: Final[Mapping[str, Callable[[Robot[RomeArmGeometry]], Any]]] = MappingProxyType(
    {name: partial(Flyer, make=make) for name, make in PATHS.items()}
)
