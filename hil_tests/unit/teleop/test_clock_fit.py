"""The laws of the clocks: whatever offset, drift and delays, an age is off by half a round trip at most."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.mavlink.clock_fit import (
    EXPIRES_AFTER,
    LEAST_OVER,
    PROVEN_AFTER,
    TOLERANCE,
    AnsweredClock,
    ReceivedClock,
)
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

if TYPE_CHECKING:
    from collections.abc import Callable

OFFSETS = st.integers(-(10**18), 10**18)
DRIFTS = st.integers(-100, 100)
DELAYS = st.integers(0, 2 * SECOND)
RESOLUTIONS = st.sampled_from([1, 10_000, MILLISECOND])


class Word(NamedTuple):
    """A sent message, and its time of arrival."""

    sent_at: Nanoseconds
    delay: Nanoseconds

    @property
    def comes_at(self) -> Nanoseconds:
        return self.sent_at + self.delay


class Answer(NamedTuple):
    """A question, and how long each way takes."""

    requested_at: Nanoseconds
    there: Nanoseconds
    back: Nanoseconds

    @property
    def comes_at(self) -> Nanoseconds:
        return self.requested_at + self.there + self.back


WORDS = st.builds(Word, st.integers(0, 60 * SECOND), DELAYS)
ANSWERS = st.builds(Answer, st.integers(0, 60 * SECOND), DELAYS, DELAYS)
REGULAR = [Answer(n * SECOND // 2, 20 * MILLISECOND, 30 * MILLISECOND) for n in range(120)]


def clock(offset: int, drift_ppm: int, resolution: int) -> Callable[[Nanoseconds], int]:
    def shows(at: Nanoseconds) -> int:
        exact = at - offset + at * drift_ppm // 1_000_000
        return exact // resolution * resolution

    return shows


@given(
    offset=OFFSETS,
    drift=DRIFTS,
    resolution=RESOLUTIONS,
    events=st.lists(st.one_of(WORDS, ANSWERS), max_size=30),
    regular=st.booleans(),
)
def test_an_age_is_off_by_half_the_shortest_round_trip_at_most(
    offset: int, drift: int, resolution: int, events: list[Word | Answer], *, regular: bool
) -> None:
    shows, fit = clock(offset, drift, resolution), AnsweredClock()
    answers: list[Answer] = []
    reported = 0
    for one in sorted([*events, *(REGULAR if regular else ())], key=lambda event: event.comes_at):
        now = one.comes_at
        if isinstance(one, Answer):
            fit.answered(one.requested_at, shows(one.requested_at + one.there), now, resolution)
            answers.append(one)
            continue
        age = fit.age(shows(one.sent_at), now)
        if age is None:
            continue
        reported += 1
        # Each answer bounds it: half its round trip, and what the clocks part since, and on the way.
        bounds = [(each.there + each.back) // 2 + (now - each.comes_at) // 10_000 for each in answers]
        off = min(bounds) + resolution + 4 * SECOND // 10_000
        assert one.delay - off <= age <= one.delay + off
    assert (
        reported
        or not regular
        or not any(isinstance(one, Word) and one.sent_at > 2 * SECOND for one in events)
    ), "a clock that is answered for every half second is known"


@given(OFFSETS, DRIFTS, RESOLUTIONS, st.lists(WORDS, min_size=1, max_size=40))
def test_a_clock_that_is_only_received_reports_no_more_than_the_truth(
    offset: int, drift: int, resolution: int, words: list[Word]
) -> None:
    shows, fit = clock(offset, drift, resolution), ReceivedClock()
    least = None
    for word in sorted(words, key=lambda one: one.comes_at):
        least = word.delay if least is None else min(least, word.delay)
        excess = fit.excess(shows(word.sent_at), word.comes_at)
        if excess is None:
            continue
        drifted = 2 * LEAST_OVER // 10_000 + 2 * resolution
        assert excess <= word.delay + drifted
        assert excess <= word.delay - least + drifted or word.comes_at > LEAST_OVER


def regular_words(delay: Callable[[Nanoseconds], Nanoseconds], seconds: int) -> list[Word]:
    return [Word(at, delay(at)) for at in range(SECOND, seconds * SECOND, 50 * MILLISECOND)]


def test_a_clock_that_is_only_received_reports_how_much_later_a_word_comes_than_the_fastest() -> None:
    shows, fit = clock(-12345, 50, MILLISECOND), ReceivedClock()
    reported = {}
    for word in regular_words(lambda at: 400 * MILLISECOND if at >= 5 * SECOND else 30 * MILLISECOND, 8):
        reported[word.sent_at] = fit.excess(shows(word.sent_at), word.comes_at)
    assert reported[SECOND + 500 * MILLISECOND] is None, "no one knows yet whether it runs"
    assert reported[4 * SECOND] == pytest.approx(0, abs=2 * MILLISECOND)
    assert reported[7 * SECOND] == pytest.approx(370 * MILLISECOND, abs=2 * MILLISECOND)


@pytest.mark.parametrize("each", [0, 10_000], ids=["stands", "counts frames"])
def test_what_does_not_run_with_time_is_no_clock(each: int) -> None:
    received, answered = ReceivedClock(), AnsweredClock()
    for n, now in enumerate(range(0, 60 * SECOND, 50 * MILLISECOND)):
        reading = 7 * SECOND + n * each
        assert received.excess(reading, now) is None
        if n % 10 == 0:
            answered.answered(now, reading, now + 20 * MILLISECOND, 1)
        assert answered.age(reading + each, now + 20 * MILLISECOND) is None


@given(
    answered_back=st.integers(1, 10),
    received_back=st.integers(0, 10),
    delays=st.lists(st.integers(0, 4_000), min_size=1, max_size=80),
    trip_ms=st.integers(0, 200),
)
def test_a_clock_that_is_only_received_moves_with_an_answered_one_only_where_it_was_set_by_as_much(
    answered_back: int, received_back: int, delays: list[int], trip_ms: int
) -> None:
    """Both run for 3 s and are set back by so many seconds; the first message since comes at once."""
    answered, received = AnsweredClock(), ReceivedClock()
    limit, trip = SECOND // 2, trip_ms * MILLISECOND
    excess: Nanoseconds | None = None
    for cycle, late_ms in enumerate([*[0] * 60, 0, *delays]):
        now = (100 + cycle) * 50 * MILLISECOND
        after = 0 if cycle < 60 else SECOND
        if cycle % 5 == 0:
            answered.answered(now - trip, now - trip // 2 - after * answered_back, now, 1)
        late = late_ms * MILLISECOND
        received.set_with(answered, now - late - after * received_back, now, limit)
        excess = received.excess(now - late - after * received_back, now)
        assert excess is None or excess >= late, "no message is made younger"
    assert excess is not None
    if answered_back == received_back and len(delays) >= 20:
        assert excess <= late + 2 * trip + TOLERANCE, "nor older, once the answered one is proven again"


def proven(theirs: Nanoseconds = 0, trip: Nanoseconds = 20 * MILLISECOND) -> AnsweredClock:
    """A clock that shows our time, and `theirs` more; answered for until 1 s."""
    fit = AnsweredClock()
    for requested_at in (0, SECOND - trip):
        fit.answered(requested_at, requested_at + trip // 2 + theirs, requested_at + trip, 1)
    return fit


def test_one_answer_does_not_prove_a_clock_and_two_that_are_close_do_not() -> None:
    fit = AnsweredClock()
    fit.answered(0, 10, 20, 1)
    assert fit.age(30, 40) is None
    fit.answered(PROVEN_AFTER + 19, PROVEN_AFTER + 25, PROVEN_AFTER + 30, 1)
    assert fit.age(PROVEN_AFTER + 35, PROVEN_AFTER + 40) is None
    fit.answered(PROVEN_AFTER + 20, PROVEN_AFTER + 26, PROVEN_AFTER + 31, 1)
    assert fit.age(PROVEN_AFTER + 35, PROVEN_AFTER + 40) is not None


@pytest.mark.parametrize("ahead", [5 * SECOND, 50 * MILLISECOND])
def test_a_clock_that_was_set_forward_is_not_known_until_it_has_answered_twice(ahead: int) -> None:
    fit, now = proven(), 2 * SECOND
    assert fit.age(now - 100 * MILLISECOND, now) == pytest.approx(100 * MILLISECOND, abs=10 * MILLISECOND)
    assert fit.age(now + ahead, now) is None
    assert fit.age(now - 100 * MILLISECOND, now) is None
    for requested_at in (2 * SECOND, 3 * SECOND):
        fit.answered(
            requested_at, requested_at + ahead + 10 * MILLISECOND, requested_at + 20 * MILLISECOND, 1
        )
    now = 4 * SECOND
    assert fit.age(now + ahead - 100 * MILLISECOND, now) == pytest.approx(
        100 * MILLISECOND, abs=10 * MILLISECOND
    )


def test_a_clock_that_was_set_back_makes_words_look_older_and_never_younger() -> None:
    fit, now = proven(), 2 * SECOND
    assert fit.age(now - 5 * SECOND, now) == pytest.approx(5 * SECOND, abs=10 * MILLISECOND)
    fit.answered(now, now - 5 * SECOND, now + 20 * MILLISECOND, 1)
    assert fit.age(now - 5 * SECOND, now + 20 * MILLISECOND) is None, "it contradicts itself"


def test_a_late_answer_makes_nothing_worse() -> None:
    fit = proven()
    fit.answered(SECOND, SECOND + MILLISECOND, 9 * SECOND, 1)
    now = 9 * SECOND
    assert fit.age(now - 300 * MILLISECOND, now) == pytest.approx(300 * MILLISECOND, abs=12 * MILLISECOND)


def test_a_clock_that_no_one_has_read_lately_is_not_known() -> None:
    fit = proven()
    assert fit.age(SECOND, SECOND + EXPIRES_AFTER) is not None
    assert fit.age(SECOND, SECOND + EXPIRES_AFTER + 1) is None


def test_stamps_may_run_a_little_ahead() -> None:
    fit, now = proven(trip=0), 2 * SECOND
    assert fit.age(now + TOLERANCE - MILLISECOND, now) == 0
    assert fit.age(now + TOLERANCE + MILLISECOND, now) is None


def excess_of(
    received: ReceivedClock, answered: AnsweredClock, late_ms: int, *, now: int, back: int = 0
) -> int | None:
    """A message of a station that answers at once; both its clocks were set back by `back` ms; in ms."""
    at, reading = now * MILLISECOND, (now - late_ms - back) * MILLISECOND
    answered.answered(at, (now - back) * MILLISECOND, at, 1)
    received.set_with(answered, reading, at, SECOND // 2)
    excess = received.excess(reading, at)
    return None if excess is None else round(excess / MILLISECOND)


def test_a_message_is_compared_with_the_fastest_one_not_with_the_first_or_the_last() -> None:
    received, answered = ReceivedClock(), AnsweredClock()
    for number, late_ms in enumerate([300, 200, 100, 250, 300] * 8):
        excess = excess_of(received, answered, late_ms, now=100 * number)
    assert excess == 200


@pytest.mark.parametrize("back", [700, 5_000, 40_000])
@pytest.mark.parametrize("faster", [0, 1])
def test_a_clock_that_was_set_with_an_answered_one_keeps_what_both_windows_knew(
    back: int, faster: int
) -> None:
    """The fastest message is of the first window, or of the second one."""
    received, answered = ReceivedClock(), AnsweredClock()
    window = LEAST_OVER // MILLISECOND
    for now in range(0, 2 * window - 1_000, 100):
        excess_of(received, answered, 300 * ((now >= window) ^ faster), now=now)
    for now in range(2 * window - 1_000, 2 * window - 100, 100):
        excess = excess_of(received, answered, 300, now=now, back=back)
    assert excess == pytest.approx(300, abs=1)
    for now in range(2 * window, 4 * window, 100):
        excess = excess_of(received, answered, 300, now=now, back=back)
    assert excess == 0, "of the last minute"
