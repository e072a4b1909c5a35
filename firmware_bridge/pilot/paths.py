"""Paths by points, close enough to be curves: m, ahead and left of where a path begins, looking along x."""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import accumulate, pairwise
from types import MappingProxyType
from typing import Final, NamedTuple, TypeAlias

from firmware_bridge.motion.pose import Pose

Point: TypeAlias = tuple[float, float]
CHORDS: Final = 720
"""Of a circle: with 5 m radius a chord is off by 0.05 mm."""


class PathError(ValueError):
    """Points that are no path; one line."""


class Nearest(NamedTuple):
    """The place of a path that is nearest to a point."""

    along_m: float
    left_m: float
    """Distance of the point to the left of the path there; at its ends its distance from them."""


class Path:
    """Chords from point to point; a closed one begins again where it ends."""

    def __init__(
        self, points: Sequence[Point], *, closed: bool = False, course_rad: float | None = None
    ) -> None:
        """Take at least two points; two that follow one another are apart.

        `course_rad`: where a curve looks at its begin; None: along the first chord.
        """
        chain = [*points, points[0]] if closed and points else list(points)
        lengths = [math.dist(a, b) for a, b in pairwise(chain)]
        if not lengths or min(lengths) <= 0.0 or not all(map(math.isfinite, lengths)):
            raise PathError("a path is made of two points at least, each apart from the one before")
        self.closed: Final = closed
        self.points: Final = tuple(chain)
        self._begins: Final = (0.0, *accumulate(lengths))
        """Distance of each point along the path."""

        self.begin: Final = Pose(*chain[0], self.at(0.0).heading_rad if course_rad is None else course_rad)

    @property
    def length_m(self) -> float:
        """From its begin to its end."""
        return self._begins[-1]

    def at(self, along_m: float) -> Pose:
        """Return place and direction so far along; an open path goes straight on at its ends."""
        along = along_m % self.length_m if self.closed else along_m
        # The last chord goes on at the end, the first one before the begin.
        place = min(max(bisect_right(self._begins, along) - 1, 0), len(self.points) - 2)
        (x, y), (to_x, to_y) = self.points[place], self.points[place + 1]
        course = math.atan2(to_y - y, to_x - x)
        on = along - self._begins[place]
        return Pose(x + on * math.cos(course), y + on * math.sin(course), course)

    def nearest(self, point: Point, low_m: float = -math.inf, high_m: float = math.inf) -> Nearest:
        """Return the nearest place between two lengths along; a closed path is looked at all around."""
        best: tuple[float, float, float] | None = None
        for place in self._chords(low_m, high_m):
            (x, y), (to_x, to_y) = self.points[place], self.points[place + 1]
            length = self._begins[place + 1] - self._begins[place]
            ahead, left = (to_x - x) / length, (to_y - y) / length
            dx, dy = point[0] - x, point[1] - y
            # The foot of the perpendicular, kept within the chord.
            on = min(max(dx * ahead + dy * left, 0.0), length)
            away = math.hypot(dx - on * ahead, dy - on * left)
            if best is None or away < best[0]:
                # The cross product of direction and offset has the sign of the side: left is positive.
                best = away, self._begins[place] + on, math.copysign(away, ahead * dy - left * dx)
        if best is None:
            raise PathError("nothing of the path is there")
        return Nearest(best[1], best[2])

    def _chords(self, low_m: float, high_m: float) -> Sequence[int]:
        count = len(self.points) - 1
        if not self.closed:
            first = max(bisect_right(self._begins, low_m) - 1, 0)
            last = min(bisect_right(self._begins, high_m), count)
            return range(min(first, count - 1), max(last, 1))
        # More than a whole round: every chord once.
        if high_m - low_m >= self.length_m:
            return range(count)
        first = bisect_right(self._begins, low_m % self.length_m) - 1
        last = bisect_right(self._begins, high_m % self.length_m) - 1
        return [one % count for one in range(first, (last if last >= first else last + count) + 1)]


def line(length_m: float) -> Path:
    """Return a straight path."""
    return Path([(0.0, 0.0), (length_m, 0.0)])


def circle(radius_m: float) -> Path:
    """Return a circle to the left, which begins at its foot."""
    return Path(_turn(radius_m, CHORDS), closed=True, course_rad=0.0)


def figure_of_eight(radius_m: float) -> Path:
    """Return a circle to the left and one to the right, which meet where it begins."""
    left = _turn(radius_m, CHORDS)
    return Path([*left, *((x, -y) for x, y in left)], closed=True, course_rad=0.0)


def _turn(radius_m: float, chords: int) -> list[Point]:
    angles = (2.0 * math.pi * place / chords for place in range(chords))
    return [(radius_m * math.sin(angle), radius_m * (1.0 - math.cos(angle))) for angle in angles]


PATHS: Final[MappingProxyType[str, Callable[[float], Path]]] = MappingProxyType(
    {"line": line, "circle": circle, "eight": figure_of_eight}
)
"""Paths by their names: each is made of its size in m, a length or a radius."""


def placed(path: Path, at: Pose, *, offset_m: float = 0.0, turned_rad: float = 0.0) -> Path:
    """Return the path for a robot that stands `at`: `offset_m` left of its begin, `turned_rad` left of it."""
    first = path.begin
    turn = at.heading_rad - turned_rad - first.heading_rad
    cosine, sine = math.cos(turn), math.sin(turn)
    x = first.x_m - offset_m * math.sin(first.heading_rad)
    y = first.y_m + offset_m * math.cos(first.heading_rad)
    points = [
        (at.x_m + (px - x) * cosine - (py - y) * sine, at.y_m + (px - x) * sine + (py - y) * cosine)
        for px, py in path.points
    ]
    course = first.heading_rad + turn
    return Path(points[:-1] if path.closed else points, closed=path.closed, course_rad=course)
