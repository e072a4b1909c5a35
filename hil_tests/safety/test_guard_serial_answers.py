"""The guard's own words on a serial line: when it speaks for the bridge, and whose the answers are."""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND
from hil_tests.safety.guard_bench import LINK
from hil_tests.safety.serial_bench import (
    ENABLE,
    HALT,
    LEFT,
    LIFT,
    TOP,
    SerialBench,
    done,
    reading,
    speed,
    states,
    word,
)


@pytest.fixture
def desk() -> SerialBench:
    return SerialBench()


def test_a_bridge_that_is_silent_is_spoken_for(desk: SerialBench) -> None:
    desk.states(speed(1000), word(LEFT, ENABLE))
    assert desk.states(now=150 * MILLISECOND - 1) == ()
    assert desk.states(now=150 * MILLISECOND) == (speed(0), word(LEFT, ENABLE))
    assert "no set-point for 150 ms" in desk.refusals[0].reason


def test_the_guard_does_not_pile_up_words_on_a_line_that_stands(desk: SerialBench) -> None:
    desk.states(speed(1000), word(LEFT, ENABLE))
    for now in range(150, 1000, 10):
        desk.states(now=now * MILLISECOND)
    assert desk.guard.refused == 1
    spoken = desk.refusals[0].sent
    assert desk.states(now=1000 * MILLISECOND) == ()
    later = 1001 * MILLISECOND
    assert desk.receives(done(speed(1000)), later)
    assert desk.receives(done(word(LEFT, ENABLE)), later)
    for packet in spoken:
        assert not desk.receives(done(packet), later)
    assert desk.states(now=1100 * MILLISECOND) == spoken


def test_answers_to_the_guard_s_own_words_are_not_the_node_s(desk: SerialBench) -> None:
    desk.states(word(LIFT, HALT))
    assert desk.receives(done(word(LIFT, HALT)))
    desk.states(reading(1, od.STATUSWORD), states(messages.SendLssFrame(bytes(8))))
    assert desk.receives(Packet(LINK, 0x10, bytes(8)))
    assert not desk.receives(done(word(LIFT, HALT)))


def test_the_answer_to_the_last_safe_word_is_that_to_the_refused_set_point(desk: SerialBench) -> None:
    """Or the node would wait for it, and say nothing meanwhile."""
    first, last = desk.states(speed(TOP + 1))
    assert not desk.receives(done(first))
    assert desk.receives(done(last))


def test_what_left_before_the_line_was_lost_is_answered_no_more(desk: SerialBench) -> None:
    desk.states(speed(TOP + 1), word(LEFT, ENABLE))
    assert desk.receives(Packet(LINK, LINE_LOST, b""))
    desk.states(speed(TOP + 1))
    assert desk.receives(Packet(LINK, LINE_BACK, b""))
    desk.states(reading(1, od.STATUSWORD))
    assert desk.receives(Packet(LINK, 0x10, bytes(8)))


def test_an_answer_that_no_one_has_requested_is_not_the_node_s(desk: SerialBench) -> None:
    assert not desk.receives(Packet(LINK, 0x10, bytes(8)))


def test_an_answer_that_is_kept_from_the_node_lets_it_act_on_the_time(desk: SerialBench) -> None:
    desk.node.wake_at = 7 * MILLISECOND
    reaction = desk.guard.receive(Packet(LINK, 0x10, bytes(8)), 3 * MILLISECOND)
    assert reaction == Reaction((), 7 * MILLISECOND)
    assert desk.node.received == [(None, 3 * MILLISECOND)]


def test_a_refusal_stops_every_axis_though_earlier_stops_wait_for_the_line(desk: SerialBench) -> None:
    desk.states(speed(1000), word(LEFT, ENABLE))
    stops = desk.states(now=150 * MILLISECOND)
    assert stops == (speed(0), word(LEFT, ENABLE))
    assert desk.states(Packet(LINK, 0x99, b""), now=151 * MILLISECOND) == stops
