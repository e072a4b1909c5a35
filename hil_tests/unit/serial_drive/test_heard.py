"""What is made of the objects that are read in a cycle: state, one instant for all positions, restarts."""

import pytest

from firmware_bridge.drivers.serial.heard import SerialEar
from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.robot import find
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.cia402 import State

AXIS = find("rars").axes[0]
CYCLE = 50 * MILLISECOND
ENABLED, DISABLED, NOT_REMOTE = 0x0337, 0x0340, 0x0140


@pytest.fixture
def ear() -> SerialEar:
    made = SerialEar(AXIS)
    made.knows_mapping = True
    return made


def cycle(ear: SerialEar, number: int, quadcounts: int, asked: Nanoseconds, word: int = ENABLED) -> None:
    begun = number * CYCLE
    ear.begin(begun)
    ear.position(quadcounts, begun + asked)
    ear.statusword(word, begun + 15 * MILLISECOND)


def test_a_sample_is_whole_when_position_and_statusword_have_come(ear: SerialEar) -> None:
    ear.begin(CYCLE)
    ear.position(100, CYCLE + MILLISECOND)
    assert ear.heard.heard_at == NEVER_HEARD
    ear.statusword(ENABLED, CYCLE + 9 * MILLISECOND)
    heard = ear.heard
    assert (heard.position_qc, heard.sampled_at, heard.heard_at) == (100, CYCLE, CYCLE + 9 * MILLISECOND)
    assert (heard.state, heard.statusword, heard.operational) == (State.OPERATION_ENABLED, ENABLED, True)


def test_a_position_of_the_cycle_before_makes_no_sample(ear: SerialEar) -> None:
    cycle(ear, 1, 100, MILLISECOND)
    ear.begin(2 * CYCLE)
    ear.statusword(ENABLED, 2 * CYCLE + MILLISECOND)
    assert ear.heard.sampled_at == CYCLE


@pytest.mark.parametrize("asked_ms", [1, 3, 8])
def test_whenever_in_the_cycle_it_is_read_the_position_is_that_of_the_begin(
    ear: SerialEar, asked_ms: int
) -> None:
    """At 20 quadcounts a millisecond: two wheels that are read apart must not look like a turn."""
    for number in (1, 2, 3):
        cycle(ear, number, 20 * (50 * number + asked_ms), asked_ms * MILLISECOND)
    assert ear.heard.position_qc == 20 * 150
    assert ear.heard.speed_rad_s == pytest.approx(20_000 / AXIS.quadcounts_per_radian)


def test_the_speed_is_taken_between_the_instants_of_the_reads(ear: SerialEar) -> None:
    cycle(ear, 1, 0, 1 * MILLISECOND)
    cycle(ear, 2, 600, 11 * MILLISECOND)
    assert ear.heard.speed_rad_s == pytest.approx(10_000 / AXIS.quadcounts_per_radian)


def test_the_counter_wraps(ear: SerialEar) -> None:
    cycle(ear, 1, 2**31 - 10, 0)
    cycle(ear, 2, -(2**31) + 10, 0)
    assert ear.heard.speed_rad_s == pytest.approx(400 / AXIS.quadcounts_per_radian)


def test_a_drive_that_is_no_longer_remote_has_restarted(ear: SerialEar) -> None:
    cycle(ear, 1, 500, 0)
    cycle(ear, 2, 0, 0, NOT_REMOTE)
    heard = ear.heard
    assert (heard.restarted, heard.operational, heard.state) == (True, False, None)
    assert (heard.speed_rad_s, heard.sampled_at) == (0.0, NEVER_HEARD)


def test_one_that_has_not_been_started_yet_has_not(ear: SerialEar) -> None:
    cycle(ear, 1, 0, 0, NOT_REMOTE)
    assert not ear.heard.restarted
    cycle(ear, 2, 0, 0, DISABLED)
    assert (ear.heard.restarted, ear.heard.state) == (False, State.SWITCH_ON_DISABLED)


def test_of_a_lost_line_nothing_is_known_any_more(ear: SerialEar) -> None:
    cycle(ear, 1, 0, 0)
    cycle(ear, 2, 1000, 0)
    ear.lose()
    heard = ear.heard
    assert (heard.state, heard.operational, heard.speed_rad_s) == (None, False, 0.0)
    assert not heard.restarted
    cycle(ear, 3, 5000, 0)
    assert heard.sampled_at == NEVER_HEARD
