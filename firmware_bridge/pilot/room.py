"""A room with posts, drawn as the robot's camera would see it: what stands for a camera on the bench.

Assumed as a whole; the robot begins in its middle.
"""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.camera import Camera, Colors, Floats, Picture

Mask: TypeAlias = NDArray[np.bool_]

SQUARE_M: Final = 0.5
"""Of the floor's pattern."""
SKY: Final = (200, 215, 230)
WALL: Final = (150, 140, 125)
FLOOR: Final = ((95, 95, 90), (125, 125, 118))


class Post(NamedTuple):
    """An upright cylinder that stands on the floor."""

    x_m: float
    y_m: float
    color: tuple[int, int, int]


def _grid(half_m: float, apart_m: float) -> tuple[Post, ...]:
    """Return posts between which a robot drives; each color of a row once, so that turns are seen."""
    places = np.arange(-half_m + apart_m / 2.0, half_m, apart_m)
    colors = ((190, 60, 50), (60, 130, 70), (60, 90, 180), (200, 160, 40), (130, 70, 150))
    return tuple(
        Post(float(x), float(y), colors[(row + 2 * column) % len(colors)])
        for row, x in enumerate(places)
        for column, y in enumerate(places)
    )


@dataclass(frozen=True, slots=True)
class Room:
    """A square room."""

    half_m: float = 12.0
    posts: tuple[Post, ...] = _grid(12.0, 2.0)
    radius_m: float = 0.08
    high_m: float = 1.2
    """Height of a post."""
    walls_m: float = 2.4


def seen(room: Room, camera: Camera, pose: Pose) -> Picture:
    """Return the camera's picture with the robot at a pose."""
    across, down = camera.focal
    right = (np.arange(camera.width, dtype=float) - camera.width / 2.0) / across
    below = (np.arange(camera.height, dtype=float) - camera.height / 2.0) / down
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    x, y = pose.x_m + camera.ahead_m * cos, pose.y_m + camera.ahead_m * sin
    # A level camera: all pixels of a column look in one direction over the floor.
    ways = np.stack((cos + sin * right, sin - cos * right))
    post, at_post = _posts(room, ways, x, y)
    at_wall = _walls(room, ways, x, y)
    color = np.empty((camera.height, camera.width, 3), dtype=np.uint8)
    depth = np.full((camera.height, camera.width), np.inf)
    color[:] = SKY
    # From the back to the front.
    _paint(color, depth, at_wall, _standing(below, at_wall, camera, room.walls_m), np.array(WALL))
    _floor(Picture(color, depth), below, ways, np.array((x, y)), camera.above_m)
    colors = np.array([one.color for one in room.posts], dtype=np.uint8)
    if room.posts:
        _paint(color, depth, at_post, _standing(below, at_post, camera, room.high_m), colors[post])
    depth[(depth < camera.nearest_m) | (depth > camera.farthest_m)] = np.nan
    return Picture(color, depth)


def _posts(room: Room, ways: Floats, x: float, y: float) -> tuple[Floats, Floats]:
    """Return by column the nearest post's number and its depth; infinite where there is none."""
    if not room.posts:
        return np.zeros(ways.shape[1], dtype=int), np.full(ways.shape[1], np.inf)
    to = np.array([(one.x_m - x, one.y_m - y) for one in room.posts])
    # |z way - to| = radius, the smaller root.
    a, b = (ways**2).sum(axis=0), to @ ways
    root = b**2 - a * ((to**2).sum(axis=1)[:, None] - room.radius_m**2)
    depth = np.where(root >= 0.0, (b - np.sqrt(np.maximum(root, 0.0))) / a, np.inf)
    depth[depth <= 0.0] = np.inf
    nearest = depth.argmin(axis=0)
    return nearest, depth[nearest, np.arange(depth.shape[1])]


def _walls(room: Room, ways: Floats, x: float, y: float) -> Floats:
    """Return by column the depth of the wall that a look from inside meets."""
    place = np.array((x, y))[:, None]
    with np.errstate(divide="ignore", over="ignore"):
        reach: Floats = (np.copysign(room.half_m, ways) - place) / ways
    reach[ways == 0.0] = np.inf
    nearest: Floats = reach.min(axis=0)
    return nearest


def _standing(below: Floats, at: Floats, camera: Camera, high_m: float) -> Mask:
    """Return which pixels look at something of a height that stands on the floor."""
    with np.errstate(invalid="ignore"):
        height: Floats = camera.above_m - below[:, None] * at[None, :]
    return (height >= 0.0) & (height <= high_m)


def _paint(color: Colors, depth: Floats, at: Floats, where: Mask, colors: Colors) -> None:
    where = where & (at[None, :] < depth)
    color[where] = np.broadcast_to(colors, color.shape)[where]
    depth[where] = np.broadcast_to(at, depth.shape)[where]


def _floor(picture: Picture, below: Floats, ways: Floats, place: Floats, above_m: float) -> None:
    color, depth = picture
    rows = below > 0.0
    at = above_m / below[rows]
    spots = place[:, None, None] + at[None, :, None] * ways[:, None, :]
    odd = np.floor(spots / SQUARE_M).sum(axis=0) % 2 == 1
    nearer = at[:, None] < depth[rows]
    color[rows] = np.where(nearer[..., None], np.array(FLOOR, dtype=np.uint8)[odd.astype(int)], color[rows])
    depth[rows] = np.where(nearer, at[:, None], depth[rows])
