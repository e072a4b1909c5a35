"""Rigid bodies in a room with cameras: where they truly are, and the markers on them.

The room's axes are x, y and, upwards, z, as a plant has them; what the stream makes of them is
`emulators.motion_capture.exposure`'s. Units are m and rad; quaternions x, y, z, w.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeAlias

from firmware_bridge.families.motion_capture.wire.frame import Point, Quaternion
from firmware_bridge.units import Nanoseconds, to_seconds


class Attitude(NamedTuple):
    """Position and attitude of a body."""

    position: Point = (0.0, 0.0, 0.0)
    attitude: Quaternion = (0.0, 0.0, 0.0, 1.0)


HERE: Final = Attitude()


def on_floor(x: float, y: float, heading: float, height: float = 0.0) -> Attitude:
    """Return the place of a body on a floor, turned to the left by `heading`."""
    return Attitude((x, y, height), (0.0, 0.0, math.sin(heading / 2.0), math.cos(heading / 2.0)))


Truth: TypeAlias = Callable[[Nanoseconds], Attitude]
"""Pose of a body at an exposure; exposures are requested in their order, some ms later."""


@dataclass(frozen=True, slots=True)
class Circling:
    """The truth of a body that no one drives: round a circle about the room's middle, to the left, ahead."""

    radius_m: float = 1.0
    speed_mps: float = 0.5
    height_m: float = 0.2

    def __call__(self, now: Nanoseconds) -> Attitude:
        """Return where it is."""
        angle = self.speed_mps / self.radius_m * to_seconds(now)
        x, y = self.radius_m * math.cos(angle), self.radius_m * math.sin(angle)
        return on_floor(x, y, angle + math.pi / 2.0, self.height_m)


@dataclass(frozen=True, slots=True)
class Standing:
    """The truth of a body that stays."""

    place: Attitude = HERE

    def __call__(self, now: Nanoseconds) -> Attitude:
        """Return where it is."""
        del now
        return self.place


@dataclass(frozen=True, slots=True)
class TrackedBody:
    """One rigid body: its number and name in the software, its markers from its pivot, and its truth."""

    id: int
    name: str
    truth: Truth
    markers: tuple[Point, ...] = ((0.15, 0.0, 0.0), (-0.1, 0.1, 0.0), (-0.1, -0.08, 0.03))


def turned(attitude: Quaternion, point: Point) -> Point:
    """Return a vector turned by a unit quaternion."""
    qx, qy, qz, qw = attitude
    px, py, pz = point
    # With t = 2 q x v the turned vector is v + w t + q x t: no matrix is needed.
    tx, ty, tz = 2 * (qy * pz - qz * py), 2 * (qz * px - qx * pz), 2 * (qx * py - qy * px)
    return (
        px + qw * tx + qy * tz - qz * ty,
        py + qw * ty + qz * tx - qx * tz,
        pz + qw * tz + qx * ty - qy * tx,
    )


def product(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the turn `second` followed by the turn `first`, both in the room's axes."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )
