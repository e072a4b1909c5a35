import pytest

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

AHEAD: Nanoseconds = 77 * SECOND
"""The robot's clock."""


def joined(up: Nanoseconds, down: Nanoseconds, seconds: int = 3) -> PilotLink:
    """Exchange requests and answers for some seconds."""
    link = PilotLink()
    for turn in range(2 * seconds):
        requested = link.question(turn * SECOND // 2 + 1)
        at = turn * SECOND // 2 + 1 + up
        link.answered(dialect.MAVLink_timesync_message(at + AHEAD, requested.ts1), at + down)
    return link


def test_before_any_answer_nothing_is_known() -> None:
    link = PilotLink()
    assert (link.round_trip(0), link.lost, link.measured_at(5, 0)) == (None, None, None)


@pytest.mark.parametrize(("up_ms", "down_ms"), [(400, 400), (0, 0), (700, 100)])
def test_the_round_trip_is_both_ways_and_a_pose_is_dated_within_half_of_it(up_ms: int, down_ms: int) -> None:
    link = joined(up_ms * MILLISECOND, down_ms * MILLISECOND)
    now = 4 * SECOND
    assert link.round_trip(now) == (up_ms + down_ms) * MILLISECOND
    measured = link.measured_at(AHEAD + 3 * SECOND, now)
    assert measured is not None
    assert measured - 3 * SECOND == pytest.approx((down_ms - up_ms) / 2 * MILLISECOND, abs=MILLISECOND)


def test_an_answer_to_no_question_sends_nothing() -> None:
    link = PilotLink()
    link.answered(dialect.MAVLink_timesync_message(5, 6), 7)
    assert link.round_trip(7) is None


def test_after_a_silence_the_round_trip_is_what_it_was() -> None:
    link = joined(SECOND // 10, SECOND // 10)
    assert link.round_trip(4 * SECOND) == SECOND // 5
    assert link.round_trip(60 * SECOND) == SECOND // 5


def test_lost_frames_are_counted_by_their_gaps() -> None:
    link = PilotLink()
    for number in range(0, 300, 2):
        link.received(number % 256, number * 50 * MILLISECOND)
    assert link.lost == pytest.approx(0.5, abs=0.02)
