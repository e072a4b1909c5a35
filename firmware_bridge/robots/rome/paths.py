"""The paths of the thesis, and those by points: where the base shall be at an instant, and how fast it moves.

Source: A. Seleit, MSc thesis, UCF, 2020, (2.20) circle, (2.21) line, (2.22) ellipse; the heading is 0.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final, NamedTuple, TypeAlias

from firmware_bridge.robots.rome.geometry import Paths

RATE: Final = 0.25
"""rad/s of circle and ellipse."""


class PathPoint(NamedTuple):
    """Position and velocity on a path: m, rad, m/s, rad/s in the path's own frame."""

    x: float
    y: float
    heading: float
    x_rate: float
    y_rate: float
    turn_rate: float


Path: TypeAlias = Callable[[float], PathPoint]


def ellipse(along: float, across: float) -> Path:
    """Return the path (a cos 0.25 t, b sin 0.25 t), which begins at (a, 0)."""

    def at(seconds: float) -> PathPoint:
        sine, cosine = math.sin(RATE * seconds), math.cos(RATE * seconds)
        return PathPoint(
            along * cosine, across * sine, 0.0, -along * RATE * sine, across * RATE * cosine, 0.0
        )

    return at


def line(speed: float) -> Path:
    """Return the path (v t, 0)."""
    return lambda seconds: PathPoint(speed * seconds, 0.0, 0.0, speed, 0.0, 0.0)


def by_points(points: tuple[tuple[float, float, float, float], ...]) -> Path:
    """Return the path straight from each point to the next, at standstill after the last; s, m, m, rad."""
    times = [point[0] for point in points]

    def at(seconds: float) -> PathPoint:
        place = bisect_right(times, seconds)
        # Before the first point and behind the last the base stands, and has no speed to follow.
        if place == 0 or place == len(points):
            _, x, y, heading = points[max(place - 1, 0)]
            return PathPoint(x, y, heading, 0.0, 0.0, 0.0)
        (t, *old), (end, *new) = points[place - 1], points[place]
        rates = [(b - a) / (end - t) for a, b in zip(old, new, strict=True)]
        x, y, heading = (a + rate * (seconds - t) for a, rate in zip(old, rates, strict=True))
        return PathPoint(x, y, heading, *rates)

    return at


PATHS: Final[Mapping[str, Callable[[Paths], Path]]] = MappingProxyType(
    {
        "circle": lambda paths: ellipse(paths.circle, paths.circle),
        "line": lambda paths: line(paths.line),
        "ellipse": lambda paths: ellipse(paths.ellipse, 1.5 * paths.ellipse),
        "points": lambda paths: by_points(paths.points or ((0.0, 0.0, 0.0, 0.0),)),
    }
)
"""Paths by the path followers' names."""
