"""A captured pose and odometry by exact numbers: each bound at its edge, interpolation, slip, and the reason.

All lengths and angles are sums of powers of 2, so that a value at a bound is at it to the last bit.
"""

import math

import pytest

from firmware_bridge.motion.captured import Bounds, Captured, Located, Sight, Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.rows import every

BOUNDS = Bounds(jump_m=0.25, jump_rad=0.5, slips=0.125, lost_m=0.75, silent=100 * MILLISECOND)
WIDE = Bounds(jump_m=100.0, jump_rad=3.0, slips=0.125, lost_m=0.75, silent=2 * SECOND)
CYCLE = 50 * MILLISECOND
SEEN = 2 * CYCLE
"""The instant of the third pose, which is believed."""
LITTLE = 1e-9
SHOWN_ASIDE = (
    "the place is off by 0.125 m at most without the cameras: they show it 0.30 m and 30 degrees off"
)


def standing(bounds: Bounds = BOUNDS) -> Captured:
    """Return one that has believed the robot to stand at the origin, in the cameras' axes and odometry's."""
    captured = Captured(bounds)
    for cycle in range(3):
        captured.step(Pose(), cycle * CYCLE, Sight(Pose(), cycle * CYCLE))
    assert captured.located == Located(Pose(), Source.CAPTURED, 0.0, 0.0, 0.0, 0, 0.0)
    return captured


def test_at_first_nothing_is_known() -> None:
    captured = Captured(BOUNDS)
    assert captured.located == Located(Pose(), Source.UNSEEN, 0.0, 0.0, 0.0, 0)
    assert captured.located.slip_mps == 0.0
    assert captured.step(Pose(1.0), 0, None) == Located(Pose(), Source.UNSEEN, 0.0, 0.0, 0.0, 0, 0.0)


@every(
    ("off_m", "off_rad", "sources"),
    [
        (0.0, 0.0, "uuc"),
        (0.25, 0.0, "uuc"),
        (0.25 + LITTLE, 0.0, "uuuc"),
        (0.0, 0.5, "uuc"),
        (0.0, -0.5, "uuc"),
        (0.0, 0.5 + LITTLE, "uuuc"),
        (0.0, -0.5 - LITTLE, "uuuc"),
        (0.0, -0.7, "uuuc"),
    ],
)
def test_three_poses_in_a_row_that_agree_are_believed(off_m: float, off_rad: float, sources: str) -> None:
    captured = Captured(BOUNDS)
    captured.step(Pose(), 0, Sight(Pose(), 0))
    for cycle, source in enumerate(sources):
        pose = Pose(off_m, 0.0, off_rad) if cycle else Pose()
        located = captured.step(Pose(), cycle * CYCLE, Sight(pose, cycle * CYCLE))
        assert located.source is {"u": Source.UNSEEN, "c": Source.CAPTURED}[source]
        assert (located.uncertain_m, located.off_m, located.off_rad, located.refused) == (0.0, 0.0, 0.0, 0)


@every(
    ("way_m", "turn_rad", "off_m", "off_rad", "believed"),
    [
        # Standing: the jump's bounds alone.
        (0.0, 0.0, 0.25, 0.5, True),
        (0.0, 0.0, 0.25 + LITTLE, 0.0, False),
        (0.0, 0.0, 0.0, 0.5 + LITTLE, False),
        (0.0, 0.0, 0.0, -0.5, True),
        (0.0, 0.0, 0.0, -0.5 - LITTLE, False),
        # An eighth of 2 m; of 100 m no more than what makes it lost.
        (2.0, 0.0, 0.5, 0.0, True),
        (2.0, 0.0, 0.5 + LITTLE, 0.0, False),
        (100.0, 0.0, 1.0, 0.0, True),
        (100.0, 0.0, 1.0 + LITTLE, 0.0, False),
        # An eighth of the turn to either side; of many turns no more than the jump once more.
        (0.0, 2.0, 0.0, 0.75, True),
        (0.0, -2.0, 0.0, -0.75, True),
        (0.0, 2.0, 0.0, 0.75 + LITTLE, False),
        (0.0, 100.0, 0.0, 1.0, True),
        (0.0, 100.0, 0.0, 1.0 + LITTLE, False),
        # Along 2 m with half a radian the way may have led elsewhere, too: 2 / 8 * 1.5.
        (2.0, -0.5, 0.625, 0.0, True),
        (2.0, -0.5, 0.625 + LITTLE, 0.0, False),
    ],
)
def test_a_pose_is_believed_as_far_off_as_a_jump_and_odometrys_error_reach(
    way_m: float, turn_rad: float, off_m: float, off_rad: float, *, believed: bool
) -> None:
    captured = standing()
    rolled = Pose(way_m, 0.0, turn_rad)
    captured.step(rolled, SEEN + CYCLE, None)
    at = SEEN + 2 * CYCLE
    seen = Pose(way_m + off_m, 0.0, turn_rad + off_rad)
    located = captured.step(rolled, at, Sight(seen, at))
    assert located.refused == (0 if believed else 1)
    assert located.off_m == pytest.approx(off_m, abs=1e-12)
    assert located.off_rad == pytest.approx(off_rad, abs=1e-12)
    assert located.pose == (seen if believed else rolled)
    assert located.uncertain_m == (0.0 if believed else 0.125 * way_m * (1.0 + abs(turn_rad)))


@every(
    ("ways", "after", "source"),
    [
        ([], BOUNDS.silent, Source.CAPTURED),
        ([], BOUNDS.silent + 1, Source.ODOMETRY),
        ([(6.0 + LITTLE, 0.0)], BOUNDS.silent, Source.CAPTURED),
        ([(6.0, 0.0)], 2 * SECOND, Source.ODOMETRY),
        ([(6.0 + LITTLE, 0.0)], 2 * SECOND, Source.LOST),
        # An eighth of 4 m, and half a radian of turn in all, to the right or to one side and back.
        ([(4.0, -0.5)], 2 * SECOND, Source.ODOMETRY),
        ([(4.0, 0.25), (4.0, 0.0)], 2 * SECOND, Source.ODOMETRY),
        ([(4.0 + LITTLE, -0.25), (4.0 + LITTLE, 0.0)], 2 * SECOND, Source.LOST),
        ([(2.0, 0.0), (-2.0, 0.0)], 2 * SECOND, Source.ODOMETRY),
        ([(2.0, 0.0), (-2.0 - LITTLE, 0.0)], 2 * SECOND, Source.LOST),
    ],
)
def test_unseen_it_is_lost_beyond_the_bound_of_the_way_times_the_turn(
    ways: list[tuple[float, float]], after: Nanoseconds, source: Source
) -> None:
    captured = standing()
    rolled = Pose()
    for cycle, (x_m, heading_rad) in enumerate(ways, start=1):
        rolled = Pose(x_m, 0.0, heading_rad)
        captured.step(rolled, SEEN + cycle, None)
    assert captured.step(rolled, SEEN + after, None).source is source


@every(
    ("samples", "at", "odometry"),
    [
        # One sample is all that is known of any instant.
        (1, 9_700, (0.0, 0.0, 0.0)),
        (1, 10_000, (0.0, 0.0, 0.0)),
        (1, 10_300, (0.0, 0.0, 0.0)),
        # Two: between them, on from them, but not back.
        (2, 9_700, (0.0, 0.0, 0.0)),
        (2, 10_000, (0.0, 0.0, 0.0)),
        (2, 10_050, (0.5, 1.0, 0.25)),
        (2, 10_100, (1.0, 2.0, 0.5)),
        (2, 10_150, (1.5, 3.0, 0.75)),
        # Four, each stretch otherwise than the one before.
        (4, 9_700, (0.0, 0.0, 0.0)),
        (4, 10_000, (0.0, 0.0, 0.0)),
        (4, 10_025, (0.25, 0.5, 0.125)),
        (4, 10_100, (1.0, 2.0, 0.5)),
        (4, 10_150, (2.0, 1.0, 0.5)),
        (4, 10_200, (3.0, 0.0, 0.5)),
        (4, 10_350, (5.0, 2.0, 0.0)),
        (4, 10_500, (7.0, 4.0, -0.5)),
        (4, 10_650, (9.0, 6.0, -1.0)),
    ],
)
def test_odometry_between_its_samples_is_on_the_straight_line(
    samples: int, at: int, odometry: tuple[float, float, float]
) -> None:
    """Cameras with odometry's own axes that show where it was at an instant, in ms, find the robot now."""
    rolled = [(10_000, Pose()), (10_100, Pose(1.0, 2.0, 0.5)), (10_200, Pose(3.0, 0.0, 0.5))]
    rolled.append((10_500, Pose(7.0, 4.0, -0.5)))
    captured = Captured(WIDE)
    for before in (9_400, 9_500):
        captured.step(Pose(), 10_000 * MILLISECOND, Sight(Pose(), before * MILLISECOND))
    for now, pose in rolled[1:samples]:
        captured.step(pose, now * MILLISECOND, None)
    now, pose = rolled[samples - 1]
    located = captured.step(pose, now * MILLISECOND, Sight(Pose(*odometry), at * MILLISECOND))
    assert located.source is Source.CAPTURED
    found = (located.pose.x_m, located.pose.y_m, located.pose.heading_rad)
    assert found == pytest.approx((pose.x_m, pose.y_m, pose.heading_rad), abs=1e-12)


def test_odometry_of_just_a_second_ago_is_remembered() -> None:
    captured = standing(WIDE)
    begin = SEEN + CYCLE
    for at, x_m in ((begin, 1.0), (begin + SECOND // 2, 2.0), (begin + SECOND, 4.0)):
        located = captured.step(Pose(x_m), at, None)
    assert located.pose == Pose(4.0)
    located = captured.step(Pose(4.0), begin + SECOND, Sight(Pose(11.0), begin))
    assert (located.refused, located.off_m, located.pose) == (0, 10.0, Pose(14.0))


def test_odometry_that_is_not_newer_counts_for_nothing() -> None:
    captured = standing()
    captured.step(Pose(1.0), SEEN + CYCLE, None)
    for at in (SEEN + CYCLE, SEEN + CYCLE, SEEN):
        assert captured.step(Pose(1.0), at, None).uncertain_m == 0.125
    ahead = Sight(Pose(2.0), SEEN + 2 * CYCLE)
    located = captured.step(Pose(1.0), SEEN + CYCLE, ahead)
    assert (located.refused, located.off_m, located.pose) == (0, 0.0, Pose(1.0))


def test_each_pose_is_judged_once_and_an_old_one_leaves_what_is_off() -> None:
    captured = standing()
    aside = Pose(0.0, 1.0, -0.25)
    for count in (1, 2, 3):
        sight = Sight(aside, SEEN + count)
        for again in range(3):
            located = captured.step(Pose(), SEEN + 10 * count + again, sight)
            assert (located.refused, located.off_m, located.off_rad) == (count, 1.0, -0.25)
    for count in (4, 5, 6):
        located = captured.step(Pose(), SEEN + 2 * SECOND, Sight(Pose(), SEEN + count))
        assert (located.refused, located.off_m, located.off_rad) == (count, 1.0, -0.25)
    # Each that is believed is taken, not one of two.
    for count in (1, 2, 3):
        now = SEEN + 2 * SECOND + count
        located = captured.step(Pose(), now, Sight(Pose(0.0, 0.0, 0.25 * count), now))
        assert (located.refused, located.off_m, located.off_rad) == (0, 0.0, 0.25)
        assert located.pose == Pose(0.0, 0.0, 0.25 * count)


@every("place", range(3))
@every("wrong", [math.nan, math.inf, -math.inf])
def test_a_first_pose_that_is_no_number_is_refused(place: int, wrong: float) -> None:
    numbers = [1.0, 2.0, 0.5]
    numbers[place] = wrong
    captured = Captured(BOUNDS)
    for count in (1, 2, 3):
        located = captured.step(Pose(), count, Sight(Pose(*numbers), count))
        assert located == Located(Pose(), Source.UNSEEN, 0.0, 0.0, 0.0, count)


@every(
    ("sights", "slip_mps"),
    [
        # Half a second after the last: 0.2 m off are 0.4 m/s, and 1 - 1/e of them is in the mean.
        ([(500, 0.2, 0.0)], 0.4 * (1.0 - math.exp(-1.0))),
        ([(500, 0.0, -0.2)], 0.4 * (1.0 - math.exp(-1.0))),
        ([(250, 0.06, 0.08)], 0.4 * (1.0 - math.exp(-0.5))),
        # Then a stretch without slip along x, and one that slips along y.
        ([(500, 0.2, 0.0), (250, 0.0, 0.0)], 0.4 * (1.0 - math.exp(-1.0)) * math.exp(-0.5)),
        (
            [(500, 0.2, 0.0), (250, 0.0, 0.1)],
            0.4 * math.hypot((1.0 - math.exp(-1.0)) * math.exp(-0.5), 1.0 - math.exp(-0.5)),
        ),
        (
            [(500, 0.0, 0.2), (250, 0.1, 0.0)],
            0.4 * math.hypot((1.0 - math.exp(-1.0)) * math.exp(-0.5), 1.0 - math.exp(-0.5)),
        ),
    ],
)
def test_slip_is_a_mean_with_a_time_constant_of_half_a_second(
    sights: list[tuple[int, float, float]], slip_mps: float
) -> None:
    """A lag of first order, in closed form: after each time T the old mean counts exp(-T / 0.5 s)."""
    captured, now = standing(), SEEN
    x_m = y_m = 0.0
    for after, along, across in sights:
        now += after * MILLISECOND
        x_m, y_m = x_m + along, y_m + across
        captured.step(Pose(), now, Sight(Pose(x_m, y_m), now))
    assert captured.located.slip_mps == pytest.approx(slip_mps, rel=1e-9)


def test_each_new_beginning_forgets_place_and_slip() -> None:
    captured, now = standing(), SEEN
    for place in (1.0, 2.0, 3.0):
        now += SECOND // 2
        slipping = captured.step(Pose(), now, Sight(Pose(captured.located.pose.x_m, 0.2), now))
        rolled = captured.step(Pose(0.0, place), now + 1, None)
        assert slipping.slip_mps > 0.2
        assert rolled.uncertain_m > 0.1
        captured.begin_again()
        forgotten = captured.located
        assert (forgotten.source, forgotten.uncertain_m, forgotten.slip_mps) == (Source.UNSEEN, 0.0, 0.0)
        assert forgotten.pose == rolled.pose
        for _ in range(4):
            now += CYCLE
            seen = captured.step(Pose(), now, Sight(Pose(place, 0.0, 0.5), now))
        assert seen == Located(Pose(place, 0.0, 0.5), Source.CAPTURED, 0.0, 0.0, 0.0, 0, 0.0)
        captured.step(Pose(), now + CYCLE, Sight(Pose(place, 0.0), now + CYCLE))


@every(
    ("source", "off_rad", "refused", "reason"),
    [
        (Source.UNSEEN, 0.5, 3, "the cameras have not seen the robot yet"),
        (Source.CAPTURED, 0.5, 3, None),
        (Source.ODOMETRY, 0.5, 3, None),
        (Source.LOST, 0.5, 0, "the place is off by 0.125 m at most without the cameras: they do not see it"),
        (Source.LOST, math.pi / 6.0, 1, SHOWN_ASIDE),
        (Source.LOST, -math.pi / 6.0, 1, SHOWN_ASIDE),
    ],
)
def test_the_reason_names_meters_and_degrees(
    source: Source, off_rad: float, refused: int, reason: str | None
) -> None:
    assert Located(Pose(), source, 0.125, 0.3, off_rad, refused).reason == reason
