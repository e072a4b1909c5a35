"""Vectors of three components, as tuples, so that equations stay readable and SymPy stays quick."""

from typing import TypeAlias

from fmu.export.functions import named
from fmu.export.model import Expression

Vector: TypeAlias = tuple[Expression, Expression, Expression]


def plus(*terms: tuple[Expression, Vector]) -> Vector:
    """Return the sum of factor x vector."""
    return (
        sum(factor * vector[0] for factor, vector in terms),
        sum(factor * vector[1] for factor, vector in terms),
        sum(factor * vector[2] for factor, vector in terms),
    )


def dot(a: Vector, b: Vector) -> Expression:
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the outer product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def kept(vector: Vector) -> Vector:
    """Return the vector, each component computed once as it is written."""
    return (named(vector[0]), named(vector[1]), named(vector[2]))


def product(
    first: tuple[Expression, Expression, Expression, Expression],
    second: tuple[Expression, Expression, Expression, Expression],
) -> tuple[Expression, Expression, Expression, Expression]:
    """Return the quaternion, x, y, z, w, of the turn `second` about a body's axes after `first`."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        named(aw * bx + ax * bw + ay * bz - az * by),
        named(aw * by - ax * bz + ay * bw + az * bx),
        named(aw * bz + ax * by - ay * bx + az * bw),
        named(aw * bw - ax * bx - ay * by - az * bz),
    )
