"""Outlines for a picture of a robot from above, in its own axes: x ahead, y to the left, m.

A pose of the robot is that of the axes' origin. Where the wheels stand and their radius are the robot file's;
how wide wheels and plates are is assumed.
"""

import math
from typing import Final, TypeAlias

Polygon: TypeAlias = tuple[tuple[float, float], ...]
CORNERS: Final = 24
"""Of a disc."""
WIDTH: Final = 0.5
"""Width of a wheel, by its radius; assumed."""


def box(ahead: float, left: float, length: float, width: float, turned: float = 0.0) -> Polygon:
    """Return a rectangle by its middle and sides in m, turned to the left by an angle in rad."""
    cosine, sine = math.cos(turned), math.sin(turned)
    corners = ((length, width), (-length, width), (-length, -width), (length, -width))
    return tuple(
        (ahead + (x * cosine - y * sine) / 2.0, left + (x * sine + y * cosine) / 2.0) for x, y in corners
    )


def wheel(ahead: float, left: float, radius: float, turned: float = 0.0) -> Polygon:
    """Return a wheel that rolls ahead, by its middle and radius in m, turned to the left by an angle."""
    return box(ahead, left, 2.0 * radius, WIDTH * radius, turned)


def disc(radius: float) -> Polygon:
    """Return a disc about the origin."""
    angles = (math.tau * place / CORNERS for place in range(CORNERS))
    return tuple((radius * math.cos(angle), radius * math.sin(angle)) for angle in angles)
