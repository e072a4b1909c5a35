"""Feedback from the objects that are read in a cycle: state, one instant for all positions, restarts."""

import pytest

from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen_drive.driver.scale import Scale
from firmware_bridge.families.epos2.driver.product import product
from firmware_bridge.families.epos2.driver.serial.feedback import SerialFeedback
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.unit.drivers.robots import RARS

AXIS = RARS.axes[0]
QUADCOUNTS_PER_RADIAN = Scale.of(AXIS).counts_per_unit
CYCLE = 50 * MILLISECOND
ENABLED, DISABLED, NOT_REMOTE = 0x0337, 0x0340, 0x0140
REFERENCED = 0x8000


@pytest.fixture
def feedback() -> SerialFeedback:
    made = SerialFeedback(AXIS, product(AXIS))
    made.expected = True
    return made


def cycle(
    feedback: SerialFeedback, number: int, quadcounts: int, requested: Nanoseconds, word: int = ENABLED
) -> None:
    begun = number * CYCLE
    feedback.begin(begun)
    feedback.position_read(quadcounts, begun + requested)
    feedback.statusword_read(word, begun + 15 * MILLISECOND)


def test_a_sample_is_whole_when_position_and_statusword_have_come(feedback: SerialFeedback) -> None:
    feedback.begin(CYCLE)
    feedback.position_read(100, CYCLE + MILLISECOND)
    assert feedback.received_at == NEVER_RECEIVED
    feedback.statusword_read(ENABLED, CYCLE + 9 * MILLISECOND)
    assert (feedback.position_counts, feedback.sampled_at, feedback.received_at) == (
        100,
        CYCLE,
        CYCLE + 9 * MILLISECOND,
    )
    assert (feedback.state, feedback.statusword, feedback.operational) == (
        PowerState.OPERATION_ENABLED,
        ENABLED,
        True,
    )


def test_a_position_of_the_cycle_before_makes_no_sample(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 100, MILLISECOND)
    feedback.begin(2 * CYCLE)
    feedback.statusword_read(ENABLED, 2 * CYCLE + MILLISECOND)
    assert feedback.sampled_at == CYCLE


@pytest.mark.parametrize("requested_ms", [1, 3, 8])
def test_whenever_in_the_cycle_it_is_read_the_position_is_that_of_the_begin(
    feedback: SerialFeedback, requested_ms: int
) -> None:
    """At 20 quadcounts a millisecond: two wheels that are read apart must not look like a turn."""
    for number in (1, 2, 3):
        cycle(feedback, number, 20 * (50 * number + requested_ms), requested_ms * MILLISECOND)
    assert feedback.position_counts == 20 * 150
    assert feedback.velocity == pytest.approx(20_000 / QUADCOUNTS_PER_RADIAN)


def test_the_speed_is_taken_between_the_instants_of_the_reads(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 0, 1 * MILLISECOND)
    cycle(feedback, 2, 600, 11 * MILLISECOND)
    assert feedback.velocity == pytest.approx(10_000 / QUADCOUNTS_PER_RADIAN)


def test_the_counter_wraps(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 2**31 - 10, 0)
    cycle(feedback, 2, -(2**31) + 10, 0)
    assert feedback.velocity == pytest.approx(400 / QUADCOUNTS_PER_RADIAN)


def test_a_drive_that_is_no_longer_remote_has_restarted(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 500, 0)
    cycle(feedback, 2, 0, 0, NOT_REMOTE)
    assert (feedback.restarted, feedback.operational, feedback.state) == (True, False, None)
    assert (feedback.velocity, feedback.sampled_at) == (0.0, NEVER_RECEIVED)


def test_one_that_has_not_been_started_yet_has_not(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 0, 0, NOT_REMOTE)
    assert not feedback.restarted
    cycle(feedback, 2, 0, 0, DISABLED)
    assert (feedback.restarted, feedback.state) == (False, PowerState.SWITCH_ON_DISABLED)


def test_of_a_lost_line_nothing_is_known_any_more(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 0, 0)
    cycle(feedback, 2, 1000, 0)
    feedback.lose()
    assert (feedback.state, feedback.operational, feedback.velocity) == (None, False, 0.0)
    assert not feedback.restarted
    cycle(feedback, 3, 5000, 0)
    assert feedback.sampled_at == NEVER_RECEIVED


@pytest.mark.parametrize("turns", [1, -1])
def test_the_position_counts_on_across_the_wrap(feedback: SerialFeedback, turns: int) -> None:
    start, step = turns * (2**31 - 3), turns * 2**29
    for number in range(1, 12):
        place = start + (number - 1) * step
        cycle(feedback, number, (place + 2**31) % 2**32 - 2**31, 0)
    assert feedback.position_counts == start + 10 * step


def test_after_a_lost_line_the_position_begins_again(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 2**31 - 10, 0)
    cycle(feedback, 2, -(2**31) + 10, 0)
    assert feedback.position_counts == 2**31 + 10
    feedback.lose()
    feedback.expected = True
    cycle(feedback, 3, -500, 0)
    assert (feedback.position_counts, feedback.velocity) == (-500, 0.0)


def test_a_drive_that_is_not_remote_any_more_has_lost_its_zero(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 100, MILLISECOND, word=ENABLED | REFERENCED)
    assert not feedback.published().reference_lost
    cycle(feedback, 2, 100, MILLISECOND, word=NOT_REMOTE | REFERENCED)
    assert feedback.published().reference_lost


def test_while_the_counter_is_set_no_way_is_a_motion(feedback: SerialFeedback) -> None:
    cycle(feedback, 1, 100, MILLISECOND)
    feedback.zeroing = True
    cycle(feedback, 2, 900_000, MILLISECOND)
    assert (feedback.velocity, feedback.position_counts) == (0.0, 900_000)
    feedback.reference_set(500)
    cycle(feedback, 3, 510, MILLISECOND)
    assert (feedback.velocity, feedback.position_counts) == (0.0, 510)
