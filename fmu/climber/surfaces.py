"""Surfaces that are climbed, by their fundamental forms: curvature, torsion, metric, and where a point lies.

Coordinates s and z are arcs in m through the origin, at right angles to each other everywhere. Another
surface is one more function here. Not known here: wheels.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from fmu.climber.vectors import Vector
from fmu.export.functions import named
from fmu.export.model import Expression


@dataclass(frozen=True, slots=True)
class SurfacePoint:
    """A point of a surface: where it lies, the normal frame there (along s, along z, outward), and its forms.

    At the surface's origin the world's axes are outward, along s, along z. M and T have two entries each, in
    the order s, z; K has those of a symmetric matrix, ss, sz, zz, in 1/m, positive where it is convex.
    """

    point: Vector
    along_s: Vector
    along_z: Vector
    normal: Vector
    metric: tuple[Expression, Expression]
    curvature: tuple[Expression, Expression, Expression]
    torsion: tuple[Expression, Expression]


Surface: TypeAlias = Callable[[Expression, Expression], SurfacePoint]
"""Function from s and z to the place there."""


def plane(s: Expression, z: Expression) -> SurfacePoint:
    """Return a place on a plane."""
    one, none = sp.S.One, sp.S.Zero
    return SurfacePoint(
        (none, s, z),
        (none, one, none),
        (none, none, one),
        (one, none, none),
        (one, one),
        (none, none, none),
        (none, none),
    )


def cylinder(radius: Expression) -> Surface:
    """Return a cylinder: s round it, z along its axis."""

    def place(s: Expression, z: Expression) -> SurfacePoint:
        inward, across, cosine = _turned(s / radius)
        one, none = sp.S.One, sp.S.Zero
        return SurfacePoint(
            (-radius * inward, radius * across, z),
            (-across, cosine, none),
            (none, none, one),
            (cosine, across, none),
            (one, one),
            (1 / radius, none, none),
            (none, none),
        )

    return place


def torus(radius: Expression, ring: Expression) -> Surface:
    """Return the outside of a torus: a tube of `radius` whose axis is a circle of radius `ring`.

    s runs round the tube, z along its outermost line. A very large ring is a cylinder, no ring a sphere.
    """

    def place(s: Expression, z: Expression) -> SurfacePoint:
        inward, across, cosine = _turned(s / radius)
        bent, ahead, straight = _turned(z / (ring + radius))
        # The radius of the circle on which z runs at this s.
        width = named(ring + radius * cosine)
        one, none = sp.S.One, sp.S.Zero
        return SurfacePoint(
            (-width * bent - radius * inward, radius * across, width * ahead),
            (-across * straight, cosine, -across * ahead),
            (-ahead, none, straight),
            (cosine * straight, across, cosine * ahead),
            (one, width / (ring + radius)),
            (1 / radius, none, cosine / width),
            (none, -across / width),
        )

    return place


def sphere(radius: Expression) -> Surface:
    """Return a sphere: z along its equator, s towards a pole, which is out of bounds."""
    return torus(radius, sp.S.Zero)


def _turned(angle: Expression) -> tuple[Expression, Expression, Expression]:
    """Return 1 - cos, sin and cos of an angle, without a difference of large numbers."""
    sine, cosine = named(sp.sin(angle / 2)), named(sp.cos(angle / 2))
    # 1 - cos(a) = 2 sin^2(a / 2): exact where a large ring makes the angle tiny.
    inward = named(2 * sine**2)
    return inward, named(2 * sine * cosine), named(1 - inward)
