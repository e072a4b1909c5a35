"""Differences and tolerated ones: both edges of the tolerance, missing, extra, lost and late."""

import hypothesis.strategies as st
import pytest
from hypothesis import given

from emulators.replay.comparison import Frames, Messages, first
from emulators.replay.player import Player
from emulators.replay.recordings import RecordedPacket, Recording
from emulators.replay.senders import BRIDGE, OPERATOR_STATION, UNKNOWN, Sent, frames_of, messages_of
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, SECOND, Nanoseconds
from firmware_bridge.wire.can import EXTENDED, REMOTE

RARS = find("rars")
A, B = Packet(CAN, 0x181, b"\x01\x02"), Packet(CAN, 0x181, b"\x01\x03")
US = MICROSECOND


def sent(at: Nanoseconds, packet: Packet = A, sender: str = "left") -> Sent:
    return Sent(RecordedPacket(at, packet, f"line {at}"), sender)


# Instants in a file are cut to microseconds: so far either way is the same.
@pytest.mark.parametrize(
    ("came_at", "tolerance", "same"),
    [
        (1000 * US, 0, True),
        (1001 * US - 1, 0, True),
        (1001 * US, 0, False),
        (999 * US + 1, 0, True),
        (999 * US, 0, False),
        (1006 * US - 1, 5 * US, True),
        (1006 * US, 5 * US, False),
        (994 * US + 1, 5 * US, True),
        (994 * US, 5 * US, False),
    ],
)
def test_both_edges_of_the_tolerance(came_at: Nanoseconds, tolerance: Nanoseconds, *, same: bool) -> None:
    comparison = Frames([sent(1000 * US)], ["left"], tolerance, SECOND)
    comparison.take(came_at, "left", A)
    assert (first([comparison], SECOND) is None) is same
    assert comparison.compared == same


def test_a_frame_is_missing_when_its_time_and_the_tolerance_are_over() -> None:
    comparison = Frames([sent(1000 * US)], ["left"], 5 * US, SECOND)
    assert first([comparison], 1006 * US) is None
    missing = first([comparison], 1006 * US + 1)
    assert missing is not None
    assert missing.wanted == sent(1000 * US)
    assert missing.came is None


@pytest.mark.parametrize(("at", "extra"), [(SECOND - 1, True), (SECOND, False)])
def test_a_frame_too_many_counts_up_to_the_end_of_the_recording(at: Nanoseconds, *, extra: bool) -> None:
    comparison = Frames([], ["left"], 0, SECOND)
    comparison.take(at, "left", A)
    found = first([comparison], SECOND)
    assert (found is not None) is extra
    if found is not None:
        assert found.wanted is None
        assert found.at == at


def test_of_several_senders_the_earliest_difference_counts() -> None:
    comparison = Frames([sent(9 * US), sent(2 * US, sender="right")], ["left", "right"], 0, SECOND)
    comparison.take(9 * US, "left", B)
    comparison.take(9 * US, "left", B)
    comparison.take(10 * US, "someone", A)
    found = first([comparison], SECOND)
    assert found is not None
    assert found.wanted == sent(2 * US, sender="right")


def message(sequence: int, text: str = "a") -> Packet:
    codec = Codec(1, 1)
    for _ in range(sequence):
        codec.encode(dialect.MAVLink_statustext_message(6, b""))
    return Packet(OPERATOR, 0, codec.encode(dialect.MAVLink_statustext_message(6, text.encode())))


def test_messages_may_come_late_doubled_out_of_order_or_not_at_all() -> None:
    recorded = [
        sent(at * MILLISECOND, message(number)) for at, number in ((30, 1), (31, 0), (32, 1), (40, 3))
    ]
    comparison = Messages(recorded, BRIDGE)
    for number in range(4):
        comparison.take(number * MILLISECOND, BRIDGE, message(number))
    comparison.take(5, OPERATOR_STATION, message(200))
    assert first([comparison], SECOND) is None
    assert comparison.compared == 4


@pytest.mark.parametrize(
    ("came", "at"),
    [(message(7, "b"), 0), (message(8), 0), (message(7), 10 * MILLISECOND + US)],
    ids=["another text", "another number", "sent after it arrived"],
)
def test_a_message_that_was_never_sent_is_a_difference(came: Packet, at: Nanoseconds) -> None:
    comparison = Messages([sent(10 * MILLISECOND, message(7))], BRIDGE)
    comparison.take(at, BRIDGE, came)
    assert first([comparison], 10 * MILLISECOND) is None, "it may still come"
    found = first([comparison], SECOND)
    assert found is not None
    assert found.wanted is not None


def test_a_sequence_number_that_comes_again_is_the_newest() -> None:
    comparison = Messages([sent(SECOND, message(0)), sent(9 * SECOND, message(256, "b"))], BRIDGE)
    comparison.take(0, BRIDGE, message(0))
    comparison.take(8 * SECOND, BRIDGE, message(256, "b"))
    assert first([comparison], 10 * SECOND) is None
    assert comparison.compared == 2


@pytest.mark.parametrize("recorded", ["a", "b"])
def test_each_recipient_has_its_own_sequence_numbers(recorded: str) -> None:
    comparison = Messages([sent(10 * MILLISECOND, message(7, recorded))], BRIDGE)
    for recipient, text in enumerate("ab"):
        comparison.take(
            recipient * MILLISECOND, BRIDGE, Packet(OPERATOR, recipient, message(7, text).payload)
        )
    assert first([comparison], SECOND) is None
    assert comparison.compared == 1


def test_what_one_recipient_was_sent_long_ago_proves_nothing_of_another() -> None:
    comparison = Messages([sent(9 * SECOND, message(7, "old"))], BRIDGE)
    comparison.take(0, BRIDGE, Packet(OPERATOR, 1, message(7, "old").payload))
    comparison.take(8 * SECOND, BRIDGE, Packet(OPERATOR, 1, message(263, "new").payload))
    found = first([comparison], 10 * SECOND)
    assert found is not None
    assert found.came is not None
    assert found.came.at == 8 * SECOND


ROWS = [
    (0x000, BRIDGE), (0x080, BRIDGE), (0x601, BRIDGE), (0x503, BRIDGE), (0x764, BRIDGE), (0x7E5, BRIDGE),
    (0x703 | REMOTE, BRIDGE), (0x181, "left"), (0x582, "right"), (0x083, "steer"), (0x704, "lift"),
    (0x705, "node 5"), (0x7E4, UNKNOWN), (0x7FF, UNKNOWN), (0x181 | EXTENDED, UNKNOWN),
]  # fmt: skip


@pytest.mark.parametrize(("address", "sender"), ROWS)
def test_the_identifier_reports_the_sender(address: int, sender: str) -> None:
    recording = Recording("a", (RecordedPacket(0, Packet(CAN, address, b"\0"), ""),))
    assert [one.sender for one in frames_of(recording, RARS, "drives")] == [sender]


def test_a_pdo_with_another_identifier_is_still_that_nodes() -> None:
    moved = Packet(CAN, 0x603, bytes.fromhex("2300180185010040"))  # transmit PDO 1 of node 3 gets 0x185
    recording = Recording(
        "a", (RecordedPacket(0, moved, ""), RecordedPacket(1, Packet(CAN, 0x185, b"\0\0"), ""))
    )
    assert [one.sender for one in frames_of(recording, RARS, "drives")] == [BRIDGE, "steer"]


def test_a_messages_header_reports_the_sender() -> None:
    theirs = Packet(OPERATOR, 0, Codec(255, 190).encode(dialect.MAVLink_statustext_message(6, b"")))
    first_version = Packet(OPERATOR, 0, bytes((0xFE, 0, 0, 1, 1, 0, 0, 0)))
    recording = Recording(
        "a", tuple(RecordedPacket(0, one, "") for one in (message(0), theirs, first_version))
    )
    assert [one.sender for one in messages_of(recording, RARS)] == [BRIDGE, OPERATOR_STATION, BRIDGE]


@given(st.lists(st.integers(0, 20)), st.lists(st.integers(0, 25)))
def test_a_player_states_everything_once_in_order_and_on_time(instants: list[int], wakes: list[int]) -> None:
    script = [(at, Packet(CAN, number, b"")) for number, at in enumerate(sorted(instants))]
    player, stated = Player(script), []
    for now in (*sorted(wakes), 30):
        reaction = player.wake(now)
        stated += [(now, packet) for packet in reaction.sent]
        assert reaction.wake_at == min((at for at, _ in script if at > now), default=NEVER)
        assert player.receive(A, now).sent == ()
    assert [packet for _, packet in stated] == [packet for _, packet in script]
    assert all(now >= at for (now, _), (at, _) in zip(stated, script, strict=True))
