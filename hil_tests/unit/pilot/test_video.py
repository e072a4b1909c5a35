"""Pictures at a low rate, each old when it is shown (A. P. Das, PhD thesis, IIT Delhi, 2018, App. A, 6.1)."""

import math
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.motion.model import Moving
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.driver import Sight
from firmware_bridge.pilot.video import Video, VideoFeed
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, from_seconds

CYCLE: Final[Nanoseconds] = 50 * MILLISECOND


def sight(at: Nanoseconds, late: Nanoseconds = 0, *, clock: bool = True) -> Sight:
    return Sight(Moving(Pose(at / SECOND, 0.0)), at if clock else None, at + late)


@given(
    st.sampled_from([1.0, 2.0, 4.0, 10.0]),
    st.floats(0.0, 2.0),
    st.integers(0, 40).map(lambda cycles: cycles * CYCLE),
)
def test_what_is_seen_is_as_old_as_the_video_and_at_most_one_period_older(
    rate: float, age: float, late: Nanoseconds
) -> None:
    feed, seen = VideoFeed(Video(rate, age)), -math.inf
    least = max(from_seconds(age), late)
    for cycle in range(100):
        now = cycle * CYCLE
        if now >= late:
            feed.filmed(sight(now - late, late))
        if (picture := feed.shown(now)) is not None:
            assert picture.measured_at is not None
            assert picture.received_at == now
            assert picture.measured_at > seen
            seen = picture.measured_at
        if seen >= 0.0:
            # Shown by the cycle after it is due, and replaced a period later.
            assert least <= now - seen <= least + from_seconds(1.0 / rate) + CYCLE
        else:
            assert now < least + CYCLE


def test_two_pictures_a_second_each_half_a_second_old() -> None:
    feed, shown = VideoFeed(Video()), []
    for now in range(0, 2 * SECOND + 1, CYCLE):
        feed.filmed(sight(now))
        if (picture := feed.shown(now)) is not None:
            shown.append((now / SECOND, picture.moving.pose.x_m))
    assert shown == [(0.5, 0.0), (1.0, 0.5), (1.5, 1.0), (2.0, 1.5)]


def test_it_is_due_when_the_next_picture_is_and_never_without_one() -> None:
    feed = VideoFeed(Video())
    assert feed.due == NEVER
    feed.filmed(sight(100 * MILLISECOND))
    assert feed.due == 600 * MILLISECOND
    assert feed.shown(600 * MILLISECOND - 1) is None
    assert feed.shown(600 * MILLISECOND) is not None
    assert feed.due == NEVER


def test_without_the_robots_clock_a_picture_is_as_old_as_it_came() -> None:
    feed = VideoFeed(Video())
    feed.filmed(sight(0, late=CYCLE, clock=False))
    assert feed.due == 550 * MILLISECOND


@pytest.mark.parametrize("at", [SECOND, 1_400 * MILLISECOND])
def test_a_pose_that_is_overtaken_or_of_the_same_period_makes_no_picture(at: Nanoseconds) -> None:
    feed = VideoFeed(Video())
    feed.filmed(sight(1_200 * MILLISECOND))
    feed.filmed(sight(at))
    assert feed.shown(3 * SECOND) == sight(1_200 * MILLISECOND)._replace(received_at=3 * SECOND)
