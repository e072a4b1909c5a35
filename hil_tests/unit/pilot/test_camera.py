"""The predicted view (A. P. Das, PhD thesis, IIT Delhi, 2018, 6.2), (6.2) corrected.

Posts in a room are drawn at an old pose, moved to the new one, and compared with the room drawn there.
"""

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.camera import UNSEEN, Camera, Floats, Picture, change_of, warped
from firmware_bridge.pilot.room import Post, Room, seen

CAMERA: Final = Camera()
CHANGE: Final = Pose(0.24, 0.03, 0.15)
OLD: Final = 0.5
"""s, of a picture (App. A)."""
TURN: Final = 0.5
"""rad/s."""


@pytest.mark.parametrize(
    ("point", "pixel", "later", "later_pixel"),
    [
        ((0.5, 0.2, 2.0), (467.34, 300.93), (0.831891, 0.2, 1.657666), (615.77, 313.51)),
        ((-0.4, 0.0, 1.5), (162.84, 240.0), None, (259.73, 240.0)),
    ],
)
def test_points_move_by_the_change_in_the_cameras_frame(
    point: tuple[float, ...],
    pixel: tuple[float, float],
    later: tuple[float, ...] | None,
    later_pixel: tuple[float, float],
) -> None:
    at = CAMERA.moved(np.array(point), CHANGE)
    assert CAMERA.pixels(np.array(point)) == pytest.approx(pixel, abs=0.005)
    assert CAMERA.pixels(at) == pytest.approx(later_pixel, abs=0.005)
    if later is not None:
        assert at == pytest.approx(later, abs=1e-6)


def test_the_sensor_is_the_thesiss() -> None:
    assert CAMERA.focal == pytest.approx((589.4, 609.3), abs=0.05)
    assert (CAMERA.width, CAMERA.height, CAMERA.nearest_m, CAMERA.farthest_m) == (640, 480, 0.8, 3.5)


poses = st.builds(Pose, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi))


@given(poses, poses, st.tuples(*(st.floats(-4.0, 4.0),) * 3))
def test_a_point_of_the_room_stays_where_it_is(before: Pose, after: Pose, point: tuple[float, ...]) -> None:
    there = _in_room(CAMERA, after, CAMERA.moved(np.array(point), change_of(before, after)))
    assert there == pytest.approx(_in_room(CAMERA, before, np.array(point)), abs=1e-9)


def _in_room(camera: Camera, pose: Pose, point: Floats) -> Floats:
    """Return a camera's point in the room, written apart from the camera."""
    turned = np.array(
        [
            [math.cos(pose.heading_rad), -math.sin(pose.heading_rad), 0.0, pose.x_m],
            [math.sin(pose.heading_rad), math.cos(pose.heading_rad), 0.0, pose.y_m],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
    placed = np.array(
        [
            [0.0, 0.0, 1.0, camera.ahead_m],
            [-1.0, 0.0, 0.0, 0.0],
            [0.0, -1.0, 0.0, camera.above_m],
            [0, 0, 0, 1],
        ]
    )
    found: Floats = (turned @ placed @ np.append(point, 1.0))[:3]
    return found


def test_a_pixel_is_the_point_that_it_shows() -> None:
    points = CAMERA.points(np.full((CAMERA.height, CAMERA.width), 2.0))
    columns, rows = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    assert np.abs(CAMERA.pixels(points) - np.stack((columns, rows), axis=-1)).max() < 1e-9


def test_odometry_in_steps_of_20_ms_is_a_millimetre_off_the_arc() -> None:
    """Euler's steps as (4.13)-(4.15) have them: 1.25 mm after 0.5 s; the robot's exact arcs: 0."""
    pose, exact = Pose(0.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0)
    for _ in range(25):
        x = pose.x_m + 0.01 * math.cos(pose.heading_rad)
        y = pose.y_m + 0.01 * math.sin(pose.heading_rad)
        pose = Pose(x, y, pose.heading_rad + 0.01)
        exact = moved(exact, 0.01 - 0.005, 0.01 + 0.005, 1.0)
    arc = Pose(math.sin(0.25), 1.0 - math.cos(0.25), 0.25)
    assert math.hypot(pose.x_m - arc.x_m, pose.y_m - arc.y_m) == pytest.approx(1.25e-3, rel=0.01)
    assert math.hypot(exact.x_m - arc.x_m, exact.y_m - arc.y_m) < 1e-12


ROOM: Final = Room(
    posts=tuple(Post(1.8 + 0.3 * n, 0.45 * (n - 3), (200, 10 + 35 * n, 30)) for n in range(6)), high_m=0.7
)


def _middles(picture: Picture) -> dict[int, float]:
    """Return the middle column of each post that is whole in the picture, by its number."""
    found = {}
    for number, post in enumerate(ROOM.posts):
        columns = np.flatnonzero((picture.color == post.color).all(axis=-1).any(axis=0))
        if columns.size and columns[0] > 0 and columns[-1] < CAMERA.width - 1:
            found[number] = (columns[0] + columns[-1]) / 2.0
    return found


def test_posts_are_where_they_are_now_and_150_pixels_beside_without_prediction() -> None:
    turned = Pose(0.0, 0.0, TURN * OLD)
    old, now = seen(ROOM, CAMERA, Pose(0.0, 0.0, 0.0)), seen(ROOM, CAMERA, turned)
    before, after = _middles(old), _middles(now)
    predicted = _middles(warped(CAMERA, old, turned))
    both = after.keys() & predicted.keys()
    assert len(both) >= 2
    for number in both:
        # A post is drawn on whole pixels twice.
        assert predicted[number] == pytest.approx(after[number], abs=1.0)
        assert abs(before[number] - after[number]) == pytest.approx(150.0, abs=25.0)


@settings(max_examples=20)
@given(st.floats(-0.3, 0.3), st.floats(-0.1, 0.1), st.floats(-0.25, 0.25))
def test_what_both_pictures_show_has_one_depth(ahead: float, left: float, turned: float) -> None:
    camera, change = CAMERA.smaller(4), Pose(ahead, left, turned)
    old, now = seen(ROOM, camera, Pose(0.0, 0.0, 0.0)), seen(ROOM, camera, change)
    predicted = warped(camera, old, change)
    both = np.isfinite(predicted.depth_m) & np.isfinite(now.depth_m)
    # What stood before something else in one of them, and edges of whole pixels, are few.
    off = np.abs(predicted.depth_m - now.depth_m)[both]
    assert both.mean() > 0.05
    assert np.quantile(off, 0.8) < 0.03


def test_where_nothing_is_known_the_picture_shows_it() -> None:
    camera = CAMERA.smaller(4)
    old = seen(ROOM, camera, Pose(0.0, 0.0, 0.0))
    there = warped(camera, old, Pose(0.0, 0.0, math.pi))
    assert np.isnan(there.depth_m).all()
    assert (there.color == UNSEEN).all()
    still = warped(camera, old, Pose(0.0, 0.0, 0.0))
    known = np.isfinite(old.depth_m)
    assert (still.color[known] == old.color[known]).all()
    assert np.nanmin(old.depth_m) >= camera.nearest_m
    assert np.nanmax(old.depth_m) <= camera.farthest_m


def test_a_room_without_posts_has_floor_and_walls() -> None:
    picture = seen(Room(posts=()), CAMERA.smaller(4), Pose(8.0, 8.0, 0.3))
    assert 0.2 < np.isfinite(picture.depth_m).mean() < 1.0
