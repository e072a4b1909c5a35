"""Vectors in the robot's axes (x ahead, y to the left, z upwards), and a sensor's mounting as a rotation."""

import math
from typing import TypeAlias

from firmware_bridge.families.imu.settings import Mounted

Vector: TypeAlias = tuple[float, float, float]
Rotation: TypeAlias = tuple[Vector, Vector, Vector]
"""A matrix by its rows."""


def rotation_of(mounted: Mounted) -> Rotation:
    """Return the rotation from the sensor's axes into the robot's: about x, then y, then z."""
    ca, sa = _turn(mounted.about_x_deg)
    cb, sb = _turn(mounted.about_y_deg)
    cc, sc = _turn(mounted.about_z_deg)
    return (
        (cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa),
        (sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa),
        (-sb, cb * sa, cb * ca),
    )


def _turn(angle_deg: float) -> tuple[float, float]:
    """Return cosine and sine, exact where the sensor is mounted by quarter turns."""
    quarters = angle_deg / 90.0
    if quarters == round(quarters):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    return math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))


def rotated(rotation: Rotation, vector: Vector) -> Vector:
    """Return a vector turned by a rotation."""
    first, second, third = rotation
    return dot(first, vector), dot(second, vector), dot(third, vector)


def dot(one: Vector, other: Vector) -> float:
    """Return the scalar product."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def cross(one: Vector, other: Vector) -> Vector:
    """Return the vector product."""
    ax, ay, az = one
    bx, by, bz = other
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def plus(one: Vector, share: float, other: Vector) -> Vector:
    """Return `one` and a share of `other`."""
    return one[0] + share * other[0], one[1] + share * other[1], one[2] + share * other[2]


def length(vector: Vector) -> float:
    """Return the length of a vector."""
    return math.sqrt(dot(vector, vector))


def unit(vector: Vector) -> Vector:
    """Return a vector of length 1 in the same direction; ZeroDivisionError for one without length."""
    share = 1.0 / length(vector)
    return vector[0] * share, vector[1] * share, vector[2] * share
