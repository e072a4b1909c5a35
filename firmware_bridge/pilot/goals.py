"""A path of one or two arcs to a goal, for a robot that drives some curvatures only.

A robot with a stuck steering turns by what its wheels leave: from a lowest to a highest curvature, both of
which may lie on one side. One arc leads to a goal where its curvature is among them. To any other goal a
first arc, at an end of the range, has to turn the robot until one does: a loop, which needs space.
"""

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

from firmware_bridge.motion.model import arc as moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.paths import Path, PathError, Point

SPARE: Final = 0.1
"""Share of the range that each end keeps for the regulation along the path."""
TURN: Final = math.radians(1.0)
"""Step in which the first arc is tried."""
TURNS: Final = 720
"""Most steps: two rounds."""
POINTS_M: Final = 0.05
"""Distance of the path's points."""


class Curvatures(NamedTuple):
    """What a robot can drive, 1/m, left positive."""

    low: float
    high: float

    @property
    def spared(self) -> "Curvatures":
        """The range without what regulation takes."""
        spare = SPARE * (self.high - self.low)
        return Curvatures(self.low + spare, self.high - spare)


class Arc(NamedTuple):
    """One arc, from where the robot is."""

    curvature_per_m: float
    length_m: float


def path_to(goal: Point, reach: Curvatures, *, loop: bool = False) -> Path:
    """Return the path to a goal, m ahead and left of the robot; PathError where none may be driven."""
    title = f"goal {goal[0]:g} m ahead and {goal[1]:g} m to the left"
    if math.hypot(*goal) < POINTS_M:
        raise PathError(f"{title}: the robot is there; a goal is {POINTS_M:g} m away at least")
    arcs = _arcs(goal, reach.spared)
    if arcs is None:
        raise PathError(
            f"{title}: with curvatures from {reach.low:.2f} to {reach.high:.2f} 1/m no loop leads there"
        )
    points = list(_points(arcs))
    if len(arcs) > 1 and not loop:
        ahead, left = ([point[axis] for point in points] for axis in (0, 1))
        raise PathError(
            f"{title}: with curvatures from {reach.low:.2f} to {reach.high:.2f} 1/m only a loop leads there, "
            f"{sum(arc.length_m for arc in arcs):.1f} m long, from {min(ahead):.1f} to {max(ahead):.1f} m "
            f"ahead and from {min(left):.1f} to {max(left):.1f} m to the left; clear that space and allow "
            "the loop"
        )
    return Path(points, course_rad=0.0)


def _arcs(goal: Point, reach: Curvatures) -> tuple[Arc, ...] | None:
    """Return the arc to a goal, or the shortest two; None where there are none."""
    direct = _last(Pose(), goal, reach)
    if direct is not None:
        return (direct,)
    loops = []
    for bend in {reach.low, reach.high} - {0.0}:
        for turn in range(1, TURNS):
            first = Arc(bend, turn * TURN / abs(bend))
            last = _last(_after(Pose(), first), goal, reach)
            if last is not None:
                loops.append((first, last))
                break
    return min(loops, key=lambda arcs: sum(one.length_m for one in arcs), default=None)


def _last(start: Pose, goal: Point, reach: Curvatures) -> Arc | None:
    """Return the arc from a pose to a goal ahead of it; None where it is behind, or the arc out of range."""
    dx, dy = goal[0] - start.x_m, goal[1] - start.y_m
    ahead = dx * math.cos(start.heading_rad) + dy * math.sin(start.heading_rad)
    left = dy * math.cos(start.heading_rad) - dx * math.sin(start.heading_rad)
    if ahead <= 0.0:
        return None
    bend = 2.0 * left / (dx * dx + dy * dy)
    if not reach.low <= bend <= reach.high:
        return None
    # The arc turns by twice the bearing of its end. Chord and bearing: of a bend that is all but 0 the turn
    # over the bend has no digits.
    bearing = math.atan2(left, ahead)
    return Arc(bend, math.hypot(dx, dy) * (bearing / math.sin(bearing) if bearing else 1.0))


def _after(start: Pose, arc: Arc, length_m: float | None = None) -> Pose:
    length = arc.length_m if length_m is None else length_m
    return moved(start, 1.0, arc.curvature_per_m, length)


def _points(arcs: tuple[Arc, ...]) -> Iterator[Point]:
    pose = Pose()
    yield pose.x_m, pose.y_m
    for arc in arcs:
        steps = max(math.ceil(arc.length_m / POINTS_M), 1)
        for step in range(1, steps + 1):
            at = _after(pose, arc, arc.length_m * step / steps)
            yield at.x_m, at.y_m
        pose = _after(pose, arc)
