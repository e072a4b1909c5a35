"""A recording with the texts of the release before: what is compared of it, and what is a difference."""

import pytest

from emulators.replay.comparison import Messages, first
from emulators.replay.earlier_texts import AllButTexts, answers_of
from emulators.replay.recordings import RecordedPacket
from emulators.replay.senders import BRIDGE, Sent
from firmware_bridge.mavlink.frames import Codec, Message, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.renamed import RenamedWarning
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds


def text(words: str) -> Message:
    return dialect.MAVLink_statustext_message(6, words.encode())


def clock(ms: int) -> Message:
    return dialect.MAVLink_system_time_message(0, ms)


def packets(*messages: Message) -> list[Packet]:
    codec = Codec(1, 1)
    return [Packet(OPERATOR, 0, codec.encode(message)) for message in messages]


def recorded(*came: Packet, at: Nanoseconds = 10 * MILLISECOND) -> list[Sent]:
    return [Sent(RecordedPacket(at + i, packet, f"message {i}"), BRIDGE) for i, packet in enumerate(came)]


def test_its_texts_choose_the_comparison() -> None:
    with pytest.warns(RenamedWarning, match="all is compared but STATUSTEXT"):
        assert isinstance(answers_of(recorded(*packets(text("released: starting"))), BRIDGE), AllButTexts)
    assert isinstance(answers_of(recorded(*packets(text("cleared: starting"))), BRIDGE), Messages)
    assert isinstance(answers_of(recorded(*packets(clock(1))), BRIDGE), Messages)


def test_texts_may_differ_in_words_and_number_and_the_rest_may_not() -> None:
    old = packets(text("released: starting"), text("it is so"), clock(1), clock(2))
    comparison = AllButTexts(recorded(*old), BRIDGE)
    for packet in packets(clock(1), text("cleared: starting"), clock(2)):
        comparison.take(0, BRIDGE, packet)
    assert first([comparison], SECOND) is None
    assert comparison.compared == 2


@pytest.mark.parametrize(
    ("sent", "at"), [([clock(1)], 0), ([clock(1), clock(3)], 0), ([clock(1), clock(2)], 12 * MILLISECOND)]
)
def test_a_message_that_was_not_sent_before_is_a_difference(sent: list[Message], at: Nanoseconds) -> None:
    comparison = AllButTexts(recorded(*packets(clock(1), clock(2))), BRIDGE)
    for packet in packets(*sent):
        comparison.take(at, BRIDGE, packet)
    assert first([comparison], 10 * MILLISECOND) is None, "it may still come"
    found = first([comparison], SECOND)
    assert found is not None
    assert found.wanted is not None


def test_the_same_message_of_a_later_instant_must_be_sent_again_and_a_doubled_one_must_not() -> None:
    one, other = packets(clock(1), clock(1))
    comparison = AllButTexts(recorded(one, one, other), BRIDGE)
    comparison.take(0, BRIDGE, one)
    found = first([comparison], SECOND)
    assert found is not None
    assert found.wanted is not None
    assert found.wanted.entry.packet == other
    assert comparison.compared == 2
