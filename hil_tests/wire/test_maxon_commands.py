"""Serial commands as bytes, in both directions, against recorded and computed frames."""

import pytest

from firmware_bridge.canopen.object_row import Provenance
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.frame import (
    ANSWER,
    Frame,
    Generation,
    checksum,
    encode_v1,
    encode_v2,
)
from firmware_bridge.families.epos2.maxon.messages import (
    Answer,
    Done,
    FrameRead,
    ObjectRead,
    Request,
    SegmentOut,
    SegmentTaken,
    control,
    length_of,
    more_of,
    toggle_of,
)
from firmware_bridge.families.epos2.maxon.opcodes import (
    COMMANDS,
    ROWS,
    decode_answer,
    decode_request,
    encode_answer,
    encode_refusal,
    encode_request,
    row_of,
)
from firmware_bridge.families.epos2.maxon.v1 import Rest
from firmware_bridge.families.epos2.maxon.v2 import Damaged, FrameReader
from hil_tests.wire.maxon_frames import EPOS4_STUFFED, EXCHANGES, Exchange

TABLE: tuple[tuple[int, Request, str, Answer, str], ...] = (
    (0x0E, messages.SendNmtService(0x0102, 0x81), "02018100", Done(0), "00000000"),
    (0x10, messages.ReadObject(0x6041, 2, 3), "41600203", ObjectRead(1, b"abcd"), "0100000061626364"),
    (0x11, messages.WriteObject(0x6040, 0, 1, b"\6\0\0\0"), "4060000106000000", Done(7), "07000000"),
    (0x12, messages.InitiateSegmentedRead(0x1008, 0, 1), "08100001", Done(0), "00000000"),
    (0x13, messages.InitiateSegmentedWrite(0x20C1, 0, 1, 8), "C120000108000000", Done(0), "00000000"),
    (0x14, messages.SegmentRead(0x40), "4000", SegmentOut(0, 0xC1, b"a"), "00000000C161"),
    (0x15, messages.SegmentWrite(0x43, b"abc"), "43616263", SegmentTaken(0, 0x43), "000000004300"),
    (0x20, messages.SendCanFrame(0x201, 2, b"12345678"), "010202003132333435363738", Done(0), "00000000"),
    (0x21, messages.RequestCanFrame(0x181, 2), "81010200", FrameRead(0, b"\1" * 8), "0000000001" + "01" * 7),
    (0x30, messages.SendLssFrame(b"12345678"), "3132333435363738", Done(0), "00000000"),
    (0x31, messages.ReadLssFrame(500), "F401", FrameRead(2, bytes(8)), "02000000" + "00" * 8),
)  # fmt: skip
"""Opcode, request, its data, answer, its data."""


@pytest.mark.parametrize(("opcode", "request_", "requested", "answer", "answered"), TABLE)
def test_each_command_both_ways(
    opcode: int, request_: Request, requested: str, answer: Answer, answered: str
) -> None:
    frame = Frame(opcode, bytes.fromhex(requested))
    assert encode_request(request_) == frame
    assert decode_request(frame) == request_
    assert encode_answer(request_, answer) == bytes.fromhex(answered)
    assert decode_answer(request_, bytes.fromhex(answered)) == answer


def test_the_table_of_commands_is_whole() -> None:
    assert [row.opcode for row in ROWS] == [
        0x0E, 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x20, 0x21, 0x22, 0x30, 0x31,
    ]  # fmt: skip
    assert sorted(COMMANDS) == [opcode for opcode, *_ in TABLE]
    silent = [row.opcode for row in ROWS if Generation.V1 not in row.answered]
    assert silent == [0x0E, 0x20]
    assert all(Generation.V2 in row.answered for row in ROWS)


def test_only_what_is_known_by_name_has_no_layout() -> None:
    nameless = [row.opcode for row in ROWS if row.request is None]
    assert nameless == [row.opcode for row in ROWS if row.provenance is Provenance.ASSUMED] == [0x16, 0x22]


@pytest.mark.parametrize(("opcode", "request_", "requested", "answer", "answered"), TABLE)
def test_a_refusal_has_the_whole_layout_of_the_answer(
    opcode: int, request_: Request, requested: str, answer: Answer, answered: str
) -> None:
    body = encode_refusal(opcode, 0x0602_0000)
    assert body[:4] == bytes.fromhex("00000206")
    assert not any(body[4:])
    reported = decode_answer(request_, body)
    assert type(reported) is type(answer)
    assert reported is not None
    assert reported.error == 0x0602_0000
    if opcode != 0x14:  # whose length is that of the data
        assert len(body) == len(bytes.fromhex(answered))
    del requested


@pytest.mark.parametrize(("opcode", "request_", "requested", "answer", "answered"), TABLE)
def test_what_is_too_short_is_nothing_and_what_is_too_long_is_cut(
    opcode: int, request_: Request, requested: str, answer: Answer, answered: str
) -> None:
    if opcode != 0x15:  # a segment may be empty, but not without its control byte
        assert decode_request(Frame(opcode, bytes.fromhex(requested)[:-2])) is None
        assert decode_request(Frame(opcode, bytes.fromhex(requested) + b"xy")) == request_
    assert decode_answer(request_, bytes.fromhex(answered)[:2]) is None
    # An error code alone is a line's answer to any frame that it does not take.
    assert decode_answer(request_, bytes.fromhex("04000405")) == Done(0x0504_0004)
    del answer


def test_unknown_commands_are_none() -> None:
    assert decode_request(Frame(0x60, bytes(8))) is None
    assert decode_request(Frame(0x16, bytes(8))) is None
    assert encode_refusal(0x60, 1) == b"\1\0\0\0"


@pytest.mark.parametrize(
    ("byte", "length", "toggle", "more"),
    [(0x00, 0, False, False), (0x3F, 63, False, False), (0x45, 5, True, False), (0xFF, 63, True, True)],
)
def test_control_byte(byte: int, length: int, toggle: bool, more: bool) -> None:  # noqa: FBT001 - a row
    assert control(length, toggle=toggle, more=more) == byte
    segment = SegmentOut(0, byte, b"")
    assert (length_of(segment), toggle_of(segment), more_of(segment)) == (length, toggle, more)


def test_a_segment_of_64_bytes_is_none() -> None:
    with pytest.raises(ValueError, match="63"):
        control(64, toggle=False)


def read_v1(raw: bytes) -> Frame | None:
    rest = Rest(raw[0])
    whole = [rest.take(byte) for byte in raw[1:]]
    assert whole == [False] * (len(whole) - 1) + [True]
    return rest.frame()


def read_v2(raw: bytes) -> list[Frame | Damaged]:
    reader = FrameReader()
    return [found for byte in raw if (found := reader.take(byte)) is not None]


@pytest.mark.parametrize("exchange", [each for each in EXCHANGES if each.v1], ids=str)
def test_golden_frames_v1(exchange: Exchange) -> None:
    assert exchange.v1 is not None
    requested, answered = map(bytes.fromhex, exchange.v1)
    frame = encode_request(exchange.request)
    assert encode_v1(frame) == requested
    assert read_v1(requested) == frame
    if Generation.V1 not in row_of(exchange.request).answered:
        assert answered == b""
        return
    reply = Frame(ANSWER, encode_answer(exchange.request, exchange.answer))
    assert encode_v1(reply) == answered
    assert read_v1(answered) == reply
    assert decode_answer(exchange.request, reply.body) == exchange.answer


@pytest.mark.parametrize("exchange", [each for each in EXCHANGES if each.v2], ids=str)
def test_golden_frames_v2(exchange: Exchange) -> None:
    assert exchange.v2 is not None
    requested, answered = map(bytes.fromhex, exchange.v2)
    frame = encode_request(exchange.request)
    reply = Frame(ANSWER, encode_answer(exchange.request, exchange.answer))
    assert encode_v2(frame) == requested
    assert encode_v2(reply) == answered
    assert read_v2(requested + answered) == [frame, reply]
    assert decode_request(frame) == exchange.request
    assert decode_answer(exchange.request, reply.body) == exchange.answer


@pytest.mark.parametrize(("opcode", "body", "raw"), EPOS4_STUFFED)
def test_stuffed_frames_of_a_sister_device(opcode: int, body: str, raw: str) -> None:
    frame = Frame(opcode, bytes.fromhex(body))
    assert encode_v2(frame) == bytes.fromhex(raw)
    assert read_v2(bytes.fromhex(raw)) == [frame]


@pytest.mark.parametrize(
    ("plain", "stuffed"),
    [("21904500", "2190904500"), ("21900245", "2190900245"), ("21909045", "219090909045")],
)
def test_stuffing_as_the_guide_of_the_epos4_shows_it(plain: str, stuffed: str) -> None:
    """EPOS4 Communication Guide, p. 2-15; the first example has one byte more, to make words."""
    assert encode_v2(Frame(0x10, bytes.fromhex(plain)))[4 : 4 + len(stuffed) // 2].hex() == stuffed


def test_the_first_word_of_the_check_sum_differs_between_the_protocols() -> None:
    body = bytes.fromhex("00100002")
    assert checksum(0x1001, body) == 0xCD10
    assert checksum(0x0210, body) == 0xF2DF


def test_frames_that_cannot_be() -> None:
    with pytest.raises(ValueError, match="whole words"):
        Frame(0x10, b"abc")
    with pytest.raises(ValueError, match="1 to 256"):
        encode_v1(Frame(0x10, b""))
    with pytest.raises(ValueError, match="at most 143"):
        encode_v2(Frame(0x10, bytes(288)))
    assert len(encode_v2(Frame(0x10, bytes(286)))) == 292
