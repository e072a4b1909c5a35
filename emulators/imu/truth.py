"""The true specific force and rates of a body, by where a plant has it at three instants.

Positions and attitudes are those of the robot's reference point: the sensor is mounted there (assumed), so
that no lever adds to its acceleration. Axes are x ahead, y to the left, z upwards; SI.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple, TypeAlias

Vector: TypeAlias = tuple[float, float, float]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]
"""A rotation by its rows, from the body's axes into the room's."""

GRAVITY: Final = 9.81
LEVEL: Final[Matrix] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
FLOOR: Final = ("x", "y", "heading")
"""Outputs of a plant that drives on a floor, by which its body is seen."""
TILT: Final = ("roll", "pitch")
"""... and from the floor's plane, where it has these: left side up, nose up, rad."""
SLOPE: Final = ("slope", "slope_heading")
"""Parameters of the floor: its angle, and where uphill is, counter-clockwise from x, rad."""
SPACE: Final = ("x", "y", "z", "qx", "qy", "qz", "qw")
"""Outputs of a robot that goes up walls: its body's place in the room, and a quaternion."""


class Posed(NamedTuple):
    """Place of a body on its floor, or in a room without one."""

    place: Vector
    """In the floor's axes: a floor that is tilted does not lift a body that stands on it somewhere."""
    floor: Matrix
    """From the floor's axes into the room's."""
    attitude: Matrix
    """From the body's axes into the room's."""


class Felt(NamedTuple):
    """What a perfect sensor has."""

    force: Vector
    """Specific force in the body's axes, m/s2: at rest 9.81 upwards."""
    rate: Vector
    """Rates about the body's axes, right-handed, rad/s."""


def posed(values: Mapping[str, float]) -> Posed:
    """Return a body by its plant's outputs and parameters, by name; missing tilt and slope are 0."""
    if "qw" in values:
        x, y, z, w = (values[name] for name in SPACE[3:])
        return Posed((values["x"], values["y"], values["z"]), LEVEL, _of_quaternion(x, y, z, w))
    slope, uphill = (values.get(name, 0.0) for name in SLOPE)
    roll, pitch = (values.get(name, 0.0) for name in TILT)
    # Nose up is left-handed about y: uphill, too, goes up by a turn to the other side.
    plane = product(product(about_z(uphill), about_y(-slope)), about_z(-uphill))
    body = product(product(about_z(values["heading"]), about_y(-pitch)), about_x(roll))
    return Posed((values["x"], values["y"], 0.0), plane, product(plane, body))


def felt(poses: Sequence[Posed], seconds: float) -> Felt:
    """Return what a body feels, by its three newest poses `seconds` apart: so long ago it was."""
    first, middle, last = poses
    squared = seconds * seconds
    moved = tuple(
        (after - 2.0 * now + before) / squared
        for before, now, after in zip(first.place, middle.place, last.place, strict=True)
    )
    ax, ay, az = turned(middle.floor, (moved[0], moved[1], moved[2]))
    return Felt(
        turned(inverse(middle.attitude), (ax, ay, az + GRAVITY)),
        _rate(product(inverse(first.attitude), last.attitude), 2.0 * seconds),
    )


def _rate(turn: Matrix, seconds: float) -> Vector:
    """Return the rates of a turn in the body's axes; it is less than half a turn."""
    trace = turn[0][0] + turn[1][1] + turn[2][2]
    angle = math.acos(min(max((trace - 1.0) / 2.0, -1.0), 1.0))
    # The skew part has the axis, times the angle's sine.
    share = (0.5 if angle < 1e-6 else angle / (2.0 * math.sin(angle))) / seconds  # noqa: PLR2004 - rad
    return (
        (turn[2][1] - turn[1][2]) * share,
        (turn[0][2] - turn[2][0]) * share,
        (turn[1][0] - turn[0][1]) * share,
    )


def about_x(angle: float) -> Matrix:
    """Return the right-handed turn about x, rad."""
    c, s = math.cos(angle), math.sin(angle)
    return (1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c)


def about_y(angle: float) -> Matrix:
    """Return the right-handed turn about y, rad."""
    c, s = math.cos(angle), math.sin(angle)
    return (c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c)


def about_z(angle: float) -> Matrix:
    """Return the right-handed turn about z, rad."""
    c, s = math.cos(angle), math.sin(angle)
    return (c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)


def _of_quaternion(x: float, y: float, z: float, w: float) -> Matrix:
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )


def product(one: Matrix, other: Matrix) -> Matrix:
    """Return the turn `other`, followed by `one`."""
    columns = tuple(zip(*other, strict=True))
    a, b, c = (tuple(_dot(row, column) for column in columns) for row in one)
    return (a[0], a[1], a[2]), (b[0], b[1], b[2]), (c[0], c[1], c[2])


def inverse(turn: Matrix) -> Matrix:
    """Return the turn back: the transposed matrix."""
    a, b, c = turn
    return (a[0], b[0], c[0]), (a[1], b[1], c[1]), (a[2], b[2], c[2])


def turned(turn: Matrix, vector: Vector) -> Vector:
    """Return a vector turned."""
    return _dot(turn[0], vector), _dot(turn[1], vector), _dot(turn[2], vector)


def _dot(one: Sequence[float], other: Sequence[float]) -> float:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
