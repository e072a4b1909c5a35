"""Drawing of a robot for the live page: what a robot type adds to its state."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeAlias, TypeVar

from firmware_bridge.motion.outline import Polygon
from firmware_bridge.robot import Robot
from firmware_bridge.robot.table import Table

G = TypeVar("G", bound=Table)
S = TypeVar("S")
Point: TypeAlias = tuple[float, float, float]
"""In the robot's axes: ahead, to the left, up from the floor, m."""


@dataclass(frozen=True)
class Drawing(Generic[G, S]):
    """A robot from above; one with an arm from the side as well."""

    above: Callable[[Robot[G]], tuple[Polygon, ...]]
    """The body, then its wheels."""
    arm: Callable[[Robot[G], S], tuple[Point, ...]] | None = None
    """The joints' places by the state of the body, from foot to tool; None for a robot without an arm."""
