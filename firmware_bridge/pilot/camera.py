"""A camera of color and depth, and its picture moved to where the robot is now.

Source: A. P. Das, PhD thesis, IIT Delhi, 2018, 6.2: the station has the newest picture, which is old, and
the robot's way since then by odometry; it moves the picture's points and projects them again. (6.2) as
printed lacks the way: points move by P' = T^-1 D^-1 T P, T the camera's place in the robot and D the change
of the robot's pose.
"""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from firmware_bridge.motion.pose import Pose

Floats: TypeAlias = NDArray[np.float64]
Colors: TypeAlias = NDArray[np.uint8]

UNSEEN: Final = (40, 40, 40)
"""Color where the moved picture shows nothing: outside the old one, hidden in it, or without a depth."""


PLANE_M: Final = 1e-3
"""A point nearer to the camera's plane, or behind it, has no pixel."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A pinhole, level and looking ahead; by default the thesis's sensor (6.2.1), its place assumed."""

    width: int = 640
    height: int = 480
    across_deg: float = 57.0
    """Field of view."""
    up_deg: float = 43.0
    nearest_m: float = 0.8
    """Depths are known from here to `farthest_m`."""
    farthest_m: float = 3.5
    ahead_m: float = 0.30
    above_m: float = 0.45

    @property
    def focal(self) -> tuple[float, float]:
        """Focal lengths along a row and along a column, pixels."""
        return (
            self.width / 2.0 / math.tan(math.radians(self.across_deg / 2.0)),
            self.height / 2.0 / math.tan(math.radians(self.up_deg / 2.0)),
        )

    def smaller(self, times: int) -> "Camera":
        """Return the same view with so many times fewer columns and rows."""
        return Camera(
            self.width // times,
            self.height // times,
            self.across_deg,
            self.up_deg,
            self.nearest_m,
            self.farthest_m,
            self.ahead_m,
            self.above_m,
        )

    def pixels(self, points: Floats) -> Floats:
        """Return column and row of points (..., 3): x right, y down, z ahead, m."""
        across, down = self.focal
        x, y, z = np.moveaxis(points, -1, 0)
        return np.stack((self.width / 2.0 + across * x / z, self.height / 2.0 + down * y / z), axis=-1)

    def points(self, depth_m: Floats) -> Floats:
        """Return each pixel's point (height, width, 3); NaN where there is no depth."""
        across, down = self.focal
        right = (np.arange(self.width) - self.width / 2.0) / across
        below = (np.arange(self.height) - self.height / 2.0) / down
        return np.stack(
            (depth_m * right[None, :], depth_m * below[:, None], depth_m),
            axis=-1,
        )

    def moved(self, points: Floats, change: Pose) -> Floats:
        """Return points as the camera sees them after the robot's change of pose, (6.2) corrected."""
        x, y, z = np.moveaxis(points, -1, 0)
        # Into the robot: x ahead, y left; the height stays what it is.
        ahead, left = z + self.ahead_m - change.x_m, -x - change.y_m
        cos, sin = math.cos(change.heading_rad), math.sin(change.heading_rad)
        return np.stack((sin * ahead - cos * left, y, cos * ahead + sin * left - self.ahead_m), axis=-1)


class Picture(NamedTuple):
    """A picture of color and depth."""

    color: Colors
    """(height, width, 3)."""
    depth_m: Floats
    """(height, width), along the camera's axis; NaN where the sensor has none."""


def change_of(before: Pose, after: Pose) -> Pose:
    """Return the second pose as the robot at the first one sees it."""
    x, y = after.x_m - before.x_m, after.y_m - before.y_m
    cos, sin = math.cos(before.heading_rad), math.sin(before.heading_rad)
    return Pose(cos * x + sin * y, cos * y - sin * x, after.heading_rad - before.heading_rad)


def warped(camera: Camera, picture: Picture, change: Pose) -> Picture:
    """Return the picture as it looks after the robot's change of pose; UNSEEN where nothing is known."""
    points = camera.moved(camera.points(picture.depth_m), change).reshape(-1, 3)
    ahead = np.flatnonzero(points[:, 2] > PLANE_M)
    places = np.rint(camera.pixels(points[ahead])).astype(int)
    inside = (places >= 0).all(axis=1) & (places < (camera.width, camera.height)).all(axis=1)
    ahead, places = ahead[inside], places[inside]
    # Farthest first: of several points on one pixel the nearest is seen.
    order = np.argsort(-points[ahead, 2], kind="stable")
    ahead, (columns, rows) = ahead[order], places[order].T
    color = np.full_like(picture.color, UNSEEN)
    depth = np.full_like(picture.depth_m, np.nan)
    color[rows, columns] = picture.color.reshape(-1, 3)[ahead]
    depth[rows, columns] = points[ahead, 2]
    return _filled(color, depth)


def _filled(color: Colors, depth: Floats) -> Picture:
    """Return the picture without the lines one pixel wide that points leave as they move apart."""
    for axis in (0, 1):
        before, after = np.roll(depth, 1, axis), np.roll(depth, -1, axis)
        hole = np.isnan(depth) & np.isfinite(before) & np.isfinite(after)
        color[hole] = np.roll(color, 1, axis)[hole]
        depth = np.where(hole, before, depth)
    return Picture(color, depth)
