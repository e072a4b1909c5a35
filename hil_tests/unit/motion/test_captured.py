"""A captured pose and odometry put together: what is believed, for how long, and when the robot is lost."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from firmware_bridge.motion.captured import AGREE, REMEMBERED, Bounds, Captured, Located, Sight, Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

BOUNDS = Bounds(jump_m=0.02, jump_rad=0.1, slips=0.05, lost_m=0.05, silent=100 * MILLISECOND)
CYCLE = 50 * MILLISECOND
DELAY = 6 * MILLISECOND
SPEED, RATE = 0.5, 0.4
START = Pose(3.0, -2.0, 1.0)


def truth(now: Nanoseconds, rate: float = RATE) -> Pose:
    """An arc from where cameras saw the robot first."""
    turn = rate * to_seconds(now)
    radius, heading = SPEED / rate, START.heading_rad
    return Pose(
        START.x_m + radius * (math.sin(heading + turn) - math.sin(heading)),
        START.y_m - radius * (math.cos(heading + turn) - math.cos(heading)),
        heading + turn,
    )


def rolled(now: Nanoseconds, slip: float = 0.0) -> Pose:
    """The same by odometry, which began elsewhere, and turned otherwise."""
    turn = RATE * to_seconds(now)
    radius = SPEED / RATE * (1.0 + slip)
    return Pose(radius * math.sin(turn), radius * (1.0 - math.cos(turn)), turn)


Seen = Callable[[Nanoseconds], Sight | None]


def seen(now: Nanoseconds) -> Sight | None:
    return Sight(truth(now - DELAY), now - DELAY)


def driven(captured: Captured, begin: int, cycles: int, sees: Seen = seen, slip: float = 0.0) -> Located:
    for cycle in range(begin, begin + cycles):
        now = cycle * CYCLE
        captured.step(rolled(now, slip), now, sees(now))
    return captured.located


def apart(one: Pose, other: Pose) -> float:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)


def test_the_delay_of_the_cameras_is_no_error() -> None:
    captured = Captured(BOUNDS)
    driven(captured, 0, AGREE)
    for cycle in range(AGREE, 200):
        located = driven(captured, cycle, 1)
        assert located.source is Source.CAPTURED
        assert apart(located.pose, truth(cycle * CYCLE)) < 1e-4
        assert located.pose.heading_rad == pytest.approx(truth(cycle * CYCLE).heading_rad, abs=1e-9)
    assert SPEED * to_seconds(DELAY) > 20e-4


def test_a_pose_newer_than_the_odometry_is_met_half_way_on() -> None:
    captured = Captured(BOUNDS)
    ahead = 8 * MILLISECOND
    located = driven(captured, 0, 40, lambda now: Sight(truth(now + ahead), now + ahead))
    assert apart(located.pose, truth(39 * CYCLE)) < 1e-4


def test_hidden_it_goes_on_by_odometry_until_that_may_be_wrong_by_the_bound() -> None:
    captured = Captured(BOUNDS)
    driven(captured, 0, 20)
    sources = []
    for cycle in range(20, 100):
        located = driven(captured, cycle, 1, lambda _: None, slip=0.0)
        sources.append(located.source)
        assert apart(located.pose, truth(cycle * CYCLE)) < 1e-3
        assert (located.uncertain_m > BOUNDS.lost_m) == (located.source is Source.LOST)
    assert sources[0] is Source.CAPTURED
    assert sources[3] is Source.ODOMETRY
    assert sources[-1] is Source.LOST
    assert "they do not see it" in (captured.located.reason or "")
    first = sources.index(Source.LOST)
    way, turn = (first + 1) * to_seconds(CYCLE) * SPEED, (first + 1) * to_seconds(CYCLE) * RATE
    assert BOUNDS.slips * way * (1 + turn) == pytest.approx(BOUNDS.lost_m, abs=0.003)
    assert driven(captured, 100, 1).source is Source.CAPTURED
    assert captured.located.reason is None


def test_standing_still_it_is_never_lost_for_being_hidden() -> None:
    captured = Captured(BOUNDS)
    for cycle in range(100):
        now = cycle * CYCLE
        captured.step(Pose(), now, Sight(START, now) if cycle < 5 else None)
    assert captured.located.source is Source.ODOMETRY
    assert captured.located.pose == START


@pytest.mark.parametrize(
    ("aside", "turn", "believed"),
    [
        (0.0, 0.0, True),
        (0.019, 0.0, True),
        (0.024, 0.0, False),
        (0.3, math.pi, False),
        (0.0, 0.09, True),
        (0.0, 0.11, False),
        (0.0, -0.11, False),
        (0.0, math.tau, True),
        (math.nan, 0.0, False),
        (0.0, math.nan, False),
        (math.inf, 0.0, False),
        (0.0, math.inf, False),
        (0.0, -math.inf, False),
    ],
)
def test_a_jump_is_refused(aside: float, turn: float, *, believed: bool) -> None:
    captured = Captured(BOUNDS)
    driven(captured, 0, 20)
    now = 20 * CYCLE
    pose = truth(now - DELAY)
    jumped = Pose(pose.x_m + aside, pose.y_m, pose.heading_rad + turn)
    located = captured.step(rolled(now), now, Sight(jumped, now - DELAY))
    assert (located.refused == 0) == believed
    expected = truth(now) if not believed else Pose(truth(now).x_m + aside, truth(now).y_m)
    assert apart(located.pose, expected) < 2e-3
    assert abs(located.pose.heading_rad - truth(now).heading_rad) < 0.1


def test_markers_swapped_for_long_lose_the_robot_and_seen_again_it_is_found() -> None:
    captured = Captured(BOUNDS)
    driven(captured, 0, 20)

    def swapped(now: Nanoseconds) -> Sight:
        pose = truth(now - DELAY)
        return Sight(replace(pose, y_m=pose.y_m + 0.3), now - DELAY)

    assert driven(captured, 20, 10, swapped).source is Source.ODOMETRY
    located = driven(captured, 30, 300, swapped)
    assert located.source is Source.LOST
    assert located.refused == 310
    assert "they show it 0.30 m and 0 degrees off" in (located.reason or "")
    assert apart(located.pose, truth(329 * CYCLE)) < 1e-3
    assert driven(captured, 330, 1).source is Source.CAPTURED


def test_carried_elsewhere_it_is_refused_until_someone_states_so() -> None:
    captured = Captured(BOUNDS)
    driven(captured, 0, 20)

    def elsewhere(now: Nanoseconds) -> Sight:
        return Sight(Pose(10.0, 10.0, 0.0), now)

    assert driven(captured, 20, 200, elsewhere).source is Source.LOST
    captured.begin_again()
    captured.step(rolled(219 * CYCLE), 219 * CYCLE, None)
    assert captured.located.source is Source.UNSEEN
    sources = [
        captured.step(rolled(219 * CYCLE), cycle * CYCLE, elsewhere(cycle * CYCLE)).source
        for cycle in range(220, 220 + AGREE)
    ]
    assert sources == [*(AGREE - 1) * [Source.UNSEEN], Source.CAPTURED]
    assert captured.located.pose == Pose(10.0, 10.0, 0.0)


def test_slip_shows_as_what_is_off_and_does_not_stay() -> None:
    captured = Captured(BOUNDS)
    located = driven(captured, 0, 100, slip=0.1)
    assert located.source is Source.CAPTURED
    assert located.off_m == pytest.approx(0.1 * SPEED * to_seconds(CYCLE), rel=0.15)
    assert apart(located.pose, truth(99 * CYCLE)) < 1e-3


def test_before_it_was_seen_it_must_not_go() -> None:
    captured = Captured(BOUNDS)
    assert driven(captured, 0, 5, lambda _: None).source is Source.UNSEEN
    assert captured.located.reason == "the cameras have not seen the robot yet"
    assert driven(captured, 5, AGREE - 1).source is Source.UNSEEN
    assert driven(captured, 5 + AGREE - 1, 1).reason is None


@pytest.mark.parametrize("turn", [0.0, math.pi])
def test_a_first_pose_that_the_next_ones_gainsay_is_never_believed(turn: float) -> None:
    """Markers taken for others while it is seen first: aside, or turned where it stands."""
    captured = Captured(BOUNDS)

    def swapped(now: Nanoseconds) -> Sight:
        pose = truth(now - DELAY)
        return Sight(Pose(pose.x_m + 0.3 * (not turn), pose.y_m, pose.heading_rad + turn), now - DELAY)

    assert driven(captured, 0, AGREE - 1, swapped).source is Source.UNSEEN
    assert driven(captured, AGREE - 1, AGREE - 1).source is Source.UNSEEN
    located = driven(captured, 2 * (AGREE - 1), 1)
    assert located.source is Source.CAPTURED
    assert apart(located.pose, truth(2 * (AGREE - 1) * CYCLE)) < 1e-3


def test_requested_again_it_states_the_same_and_an_old_pose_counts_once() -> None:
    captured = Captured(BOUNDS)
    driven(captured, 0, 10)
    now = 10 * CYCLE
    sight = seen(now)
    first = captured.step(rolled(now), now, sight)
    assert captured.step(rolled(now), now, sight) == first
    assert driven(captured, 11, 5, lambda _: sight).source is Source.ODOMETRY


def test_what_is_too_old_to_be_put_upon_anything_is_refused() -> None:
    captured = Captured(BOUNDS)
    driven(captured, 0, 10)
    driven(captured, 10, 30, lambda _: None)
    now = 40 * CYCLE
    at = now - REMEMBERED - 1
    assert captured.step(rolled(now), now, Sight(truth(at), at)).refused == 1
    at = now - REMEMBERED + 1
    assert captured.step(rolled(now), now, Sight(truth(at), at)).refused == 0


@pytest.mark.parametrize(("turn", "believed"), [(0.149, True), (0.151, False), (0.3, False)])
def test_after_a_turn_in_the_dark_the_heading_may_be_off_by_its_share(turn: float, *, believed: bool) -> None:
    captured = Captured(BOUNDS)
    for cycle in range(AGREE):
        captured.step(Pose(), cycle, Sight(START, cycle))
    for cycle in range(1, 11):
        captured.step(Pose(heading_rad=0.1 * cycle), cycle * CYCLE, None)
    seen_at = Pose(START.x_m, START.y_m, START.heading_rad + 1.0 + turn)
    located = captured.step(Pose(heading_rad=1.0), 10 * CYCLE, Sight(seen_at, 10 * CYCLE))
    assert (located.refused == 0) == believed


def test_slip_is_reported_as_a_speed_and_is_over_when_the_wheels_hold_again() -> None:
    captured = Captured(BOUNDS)
    assert driven(captured, 0, 40).slip_mps < 1e-4
    # Odometry with 10 % more is off by 0.05 m/s; after two seconds all but 2 % of it is in the mean.
    slipping = Captured(BOUNDS)
    assert driven(slipping, 0, 40, slip=0.1).slip_mps == pytest.approx(0.1 * SPEED, rel=0.15)
    hidden = driven(slipping, 40, 2, sees=lambda _: None, slip=0.1).slip_mps
    assert hidden == slipping.located.slip_mps > 0.04
    at = 42 * CYCLE
    for cycle in range(42, 82):
        now = cycle * CYCLE
        slipping.step(rolled(at, 0.1), now, Sight(truth(at - DELAY), now - DELAY))
    assert slipping.located.slip_mps < 0.002


def test_begun_again_it_is_unseen_at_once_and_has_no_slip() -> None:
    captured = Captured(BOUNDS)
    before = driven(captured, 0, 40, slip=0.1)
    captured.begin_again()
    located = captured.located
    assert (located.source, located.slip_mps, located.pose) == (Source.UNSEEN, 0.0, before.pose)
    assert located.reason is not None
