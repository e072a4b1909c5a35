"""Serial commands and MAVLink messages in words, and links that are called otherwise than their kind."""

import hypothesis.strategies as st
from hypothesis import given

from firmware_bridge.dissector import Carried, Dissector, first_difference
from firmware_bridge.families.epos2.maxon.frame import Failure, Generation, MaxonAnswer
from firmware_bridge.families.epos2.maxon.messages import ObjectRead, ReadObject
from firmware_bridge.families.epos2.maxon.opcodes import encode_answer, row_of
from firmware_bridge.families.epos2.maxon.packets import MAXON, command, outcome_packet
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import CAN, OPERATOR, SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.wire.maxon_dialogues import Cut, dialogue, every_exchange, fragmented
from hil_tests.wire.maxon_frames import Exchange

READ = ReadObject(0x6041, 0, 1)


def carried(link: str, sender: str, packet: Packet) -> Carried:
    return Carried(SECOND + 2 * MILLISECOND, link, sender, packet)


def line(chunk: bytes) -> Packet:
    return Packet(SERIAL, 0, chunk)


@fragmented
@every_exchange
def test_a_serial_line_is_read_as_commands(exchange: Exchange, generation: Generation, cut: Cut) -> None:
    dissector = Dissector()
    texts = [
        dissector.read(carried(SERIAL, sender, line(chunk)))
        for sender, stated in dialogue(exchange, generation)
        for chunk in cut(stated)
    ]
    row = row_of(exchange.request)
    assert sum(f"  {row.name}: " in text for text in texts) == 1
    assert sum("answer: error " in text for text in texts) == (generation in row.answered)


def test_an_objects_name_and_the_answer_to_it() -> None:
    dissector = Dissector()
    answer = outcome_packet(0x10, MaxonAnswer(encode_answer(READ, ObjectRead(0, b"\x37\x07\0\0"))))
    texts = [
        dissector.read(carried(MAXON, "bridge", command(READ))),
        dissector.read(carried(MAXON, "drive", answer)),
        dissector.read(carried(MAXON, "drive", outcome_packet(0x10, Failure.SILENCE))),
    ]
    assert [text.removeprefix("1.002000000 s  maxon  ") for text in texts] == [
        "bridge  10#41600001  ReadObject: 0x6041 Statusword, node 1",
        "drive  10#0000000037070000  answer: error 0, raw 37 07 00 00",
        "drive  110#6E6F20616E7377657220696E2074696D... (17 bytes)  no answer: no answer in time",
    ]


def test_a_message_with_its_fields_and_their_words() -> None:
    message = dialect.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    text = Dissector().read(carried(OPERATOR, "pilot", Packet(OPERATOR, 0, Codec(255, 190).encode(message))))
    assert "COMMAND_LONG #0 of 255/190: target_system=1 target_component=1 " in text
    assert "command=400 (MAV_CMD_COMPONENT_ARM_DISARM)" in text


def test_a_link_may_have_a_name_of_its_own() -> None:
    kinds = {"base": CAN}
    unknown = Dissector().read(carried("base", "bridge", Packet("base", 0x080, b"\x01")))
    assert unknown.endswith("  base  bridge  01  on a link of unknown kind")
    assert Dissector(kinds).read(carried("base", "bridge", Packet("base", 0x080, b""))).endswith("080#  SYNC")


def test_the_first_difference_has_what_came_before_and_what_each_side_knew() -> None:
    same = [carried(CAN, "bridge", Packet(CAN, 0x080, b""))] * 8
    ours, theirs = (carried(CAN, "left", Packet(CAN, 0x181, bytes((low, 0x07)))) for low in (0x37, 0x17))
    assert first_difference(same, same) is None
    reported = first_difference([*same, ours, ours], [*same, theirs])
    assert reported is not None
    head, *context, expected, came = reported.splitlines()
    assert head == "packet 9 is the first that differs"
    assert len(context) == 5
    assert "operation enabled" in expected
    assert "quick stop active" in came


def test_bytes_that_say_the_same_are_shown() -> None:
    ours, theirs = (
        carried(OPERATOR, "pilot", Packet(OPERATOR, 0, bytes(40) + tail)) for tail in (b"\x01", b"\x02")
    )
    reported = first_difference([ours], [theirs])
    assert reported is not None
    assert reported.endswith(f"bytes     {'00' * 40}01\nbut came  {'00' * 40}02")


@given(
    st.lists(
        st.tuples(st.sampled_from((SERIAL, OPERATOR, MAXON)), st.integers(0, 0x1FF), st.binary()), max_size=9
    )
)
def test_whatever_comes_has_a_line(sent: list[tuple[str, int, bytes]]) -> None:
    dissector = Dissector()
    for number, (link, address, payload) in enumerate(sent):
        assert dissector.read(carried(link, f"end {number % 2}", Packet(link, address, payload)))
