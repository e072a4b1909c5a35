"""Pure pursuit: the arc to a goal on the path, one look-ahead away.

Source: A. P. Das, PhD thesis, IIT Delhi, 2018, (5.3)-(5.5): r = l2 / (2 x), W = -v / r with the goal's offset
x to the right; here left is positive. The goal is where a circle of the look-ahead around the robot leaves
the path in the driving direction; where it meets none, it is enlarged.
"""

import math
from typing import Final, NamedTuple

from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.paths import Path, Point

LARGER: Final = 1.1
"""So much the look-ahead is enlarged at a time."""
GRAZES: Final = 1.01
"""A circle that is larger than the distance to the path by no more only touches it."""
STEP_M: Final = 0.02
"""Between two places that are looked at for the goal; it is then found exactly."""
BEHIND_M: Final = 1.0
"""So far back the nearest place is looked for, where a robot is driven round it."""
NEWTON: Final = 50
"""Steps for a root; it doubles its digits in each of the last few."""
AHEAD: Final = 4.0
"""So many look-aheads forward it is looked for."""


def critical_delay_s(speed_mps: float, look_ahead_m: float, lag_s: float = 0.0) -> float:
    """Return the dead time of the whole loop from which on it swings about a line, s; negative for always.

    `lag_s`: the steering's time constant. Linearized, with n = v / L: T s3 + s2 + (2 n s + 2 n2) e^(-s tau)
    = 0, (App. B, B.2) with the goal's own offset e + L theta; as printed it lacks the heading. On the
    imaginary axis T2 w6 + w4 - 4 n2 w2 - 4 n4 = 0, and tau = (atan(w / n) - atan(T w)) / w: without a lag
    w2 = (2 + 2 sqrt 2) n2; with one of L / v it swings without any delay.
    """
    rate = speed_mps / look_ahead_m
    # In units of n: of the cubic in w2 one root is positive, and Newton comes to it from above.
    lag = lag_s * rate
    square = 2.0 + 2.0 * math.sqrt(2.0)
    for _ in range(NEWTON):
        rest = lag**2 * square**3 + square**2 - 4.0 * square - 4.0
        square -= rest / (3.0 * lag**2 * square**2 + 2.0 * square - 4.0)
    swing = math.sqrt(square)
    return (math.atan(swing) - math.atan(lag * swing)) / (swing * rate)


class Arc(NamedTuple):
    """The arc that leads to the goal."""

    curvature_per_m: float
    """Left positive."""
    goal: Point
    look_ahead_m: float
    """As it had to be enlarged."""


class Pursuit:
    """One robot on one path."""

    def __init__(self, path: Path, look_ahead_m: float) -> None:
        self.path: Final = path
        self._look_ahead: Final = look_ahead_m
        self._along: float | None = None
        """Distance along the path so far; None before it begins."""

    @property
    def ended(self) -> bool:
        """True where the end of an open path is reached, to a step."""
        return not self.path.closed and self._along is not None and self._along >= self.path.length_m - STEP_M

    @property
    def left_m(self) -> float:
        """The way along the path that is left; infinite on a closed one."""
        return math.inf if self.path.closed else self.path.length_m - (self._along or 0.0)

    def arc(self, pose: Pose) -> Arc:
        """Return the arc from here to the goal."""
        low, high = -math.inf, math.inf
        if self._along is not None:
            low, high = self._along - BEHIND_M, self._along + AHEAD * self._look_ahead
        self._along, away = self.path.nearest((pose.x_m, pose.y_m), low, high)
        distance = self._look_ahead
        # Where the circle does not reach the path there is no goal.
        while distance <= GRAZES * abs(away):
            distance *= LARGER
        goal = self._goal(pose, self._along, distance)
        dx, dy = goal[0] - pose.x_m, goal[1] - pose.y_m
        left = dy * math.cos(pose.heading_rad) - dx * math.sin(pose.heading_rad)
        # (5.3): the radius is l^2 / (2 x), the curvature its inverse.
        return Arc(2.0 * left / (dx * dx + dy * dy), goal, distance)

    def _goal(self, pose: Pose, along: float, distance: float) -> Point:
        """Go forward from the nearest place until the path leaves the circle."""
        inside, farthest = along, along + (self.path.length_m if self.path.closed else math.inf)
        outside = along + STEP_M
        while outside < farthest and self._apart(pose, outside) < distance:
            inside, outside = outside, outside + STEP_M
        # Bisection: 20 halvings of 20 mm leave 20 nm.
        for _ in range(20):
            middle = (inside + outside) / 2.0
            if self._apart(pose, middle) < distance:
                inside = middle
            else:
                outside = middle
        place = self.path.at(outside)
        return place.x_m, place.y_m

    def _apart(self, pose: Pose, along: float) -> float:
        place = self.path.at(along)
        return math.hypot(place.x_m - pose.x_m, place.y_m - pose.y_m)
