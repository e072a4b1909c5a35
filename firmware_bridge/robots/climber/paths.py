"""The climber's paths on the unrolled surface, leg by leg: straight ones and an arc, with corners between.

Source: Qualls et al., JAMRIS 10(3), 2016, names them: vertical, horizontal, spiral of 45 degrees and circle;
triangle, square and diamond in closed loop. How large they are is the robot file's.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final, NamedTuple, TypeAlias

from firmware_bridge.robots.climber.geometry import Paths

UP: Final = math.pi / 2.0
STRAIGHT_RAD: Final = 1e-9
"""A chord over less is as long as its arc."""


class PathLeg(NamedTuple):
    """A piece that is driven without turning on the spot: m, rad, 1/m to the left."""

    length: float
    heading: float
    """Its direction at the start, from the arc towards the axis."""
    bend: float = 0.0

    def at(self, way: float) -> tuple[float, float, float]:
        """Return arc, height and heading so far along it, from where it begins; m, m, rad."""
        turn = self.bend * way
        half = 0.5 * turn
        # Chord of an arc: sin(half) / half of its length, and 0 / 0 on a straight line.
        chord = way if abs(half) < STRAIGHT_RAD else way * math.sin(half) / half
        course = self.heading + half
        return chord * math.cos(course), chord * math.sin(course), self.heading + turn


Path: TypeAlias = tuple[PathLeg, ...]


def polygon(side: float, headings: tuple[float, ...]) -> Path:
    """Return sides of one length, one after the other."""
    return tuple(PathLeg(side, heading) for heading in headings)


def _degrees(*headings: float) -> tuple[float, ...]:
    return tuple(map(math.radians, headings))


PATHS: Final[Mapping[str, Callable[[Paths], Path]]] = MappingProxyType(
    {
        "vertical": lambda paths: (PathLeg(paths.length_m, UP),),
        "horizontal": lambda paths: (PathLeg(paths.length_m, 0.0),),
        "spiral": lambda paths: (PathLeg(paths.length_m, math.pi / 4.0),),
        "circle": lambda paths: (PathLeg(math.tau * paths.radius_m, UP, 1.0 / paths.radius_m),),
        "triangle": lambda paths: polygon(paths.side_m, _degrees(90.0, -30.0, -150.0)),
        "square": lambda paths: polygon(paths.side_m, _degrees(90.0, 0.0, -90.0, -180.0)),
        "diamond": lambda paths: polygon(paths.side_m, _degrees(45.0, 135.0, 225.0, 315.0)),
    }
)
"""Paths by the path followers' names; each begins where the robot stands."""
