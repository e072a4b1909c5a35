"""Frames of an IMU to the byte: golden ones both ways, the CRC's boundary, any bytes between them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.dissector.lines import UNREAD
from firmware_bridge.families.imu.dissector import ImuLine
from firmware_bridge.families.imu.wire import (
    LENGTH,
    SYNC,
    FrameReader,
    ImuFrame,
    Status,
    crc,
    decoded,
    encoded,
)
from firmware_bridge.packet import Packet

GOLDEN = [
    # By hand, from the table of the protocol: level and at rest, 1 s after the device's start.
    (
        "A5 5A 07 00 E8030000 0000 0000 0020 0000 0000 0000 65EB",
        ImuFrame(7, 0, 1000, (0, 0, 8192), (0, 0, 0)),
    ),
    # Every field at an end: counter and clock before they wrap, ranges, 2 deg/s to either side.
    (
        "A5 5A FF 06 FFFFFFFF 0080 FF7F 0100 FFFF 8300 7DFF 6E46",
        ImuFrame(255, 6, 0xFFFF_FFFF, (-32768, 32767, 1), (-1, 131, -131)),
    ),
]
WORD = st.integers(-32768, 32767)
VALUES = st.tuples(WORD, WORD, WORD)
FRAMES = st.builds(
    ImuFrame, st.integers(0, 255), st.integers(0, 255), st.integers(0, 2**32 - 1), VALUES, VALUES
)


def bitwise(data: bytes) -> int:
    """Return CRC-16/IBM-3740, bit by bit, as its definition has it."""
    register = 0xFFFF
    for byte in data:
        register ^= byte << 8
        for _ in range(8):
            register = (register << 1 ^ (0x1021 if register & 0x8000 else 0)) & 0xFFFF
    return register


@pytest.mark.parametrize(("text", "frame"), GOLDEN)
def test_golden_frames_both_ways(text: str, frame: ImuFrame) -> None:
    data = bytes.fromhex(text)
    assert encoded(frame) == data
    assert decoded(data) == frame


def test_the_crc_has_the_check_value_of_its_catalogue() -> None:
    assert crc(b"123456789") == 0x29B1


@given(st.binary(max_size=40))
def test_the_crc_is_that_of_its_definition(data: bytes) -> None:
    assert crc(data) == bitwise(data)


@given(FRAMES)
def test_a_frame_comes_back(frame: ImuFrame) -> None:
    assert decoded(encoded(frame)) == frame


def test_one_wrong_bit_anywhere_is_no_frame() -> None:
    data = encoded(GOLDEN[1][1])
    for place in range(LENGTH * 8):
        wrong = bytearray(data)
        wrong[place // 8] ^= 1 << place % 8
        assert decoded(bytes(wrong)) is None, place


@given(st.lists(FRAMES, max_size=4), st.lists(st.integers(1, 30), min_size=1))
def test_frames_are_found_however_the_line_is_cut(frames: list[ImuFrame], cuts: list[int]) -> None:
    data, reader, found = b"".join(map(encoded, frames)), FrameReader(), []
    while data:
        for cut in cuts:
            found += list(reader.receive(data[:cut]))
            data = data[cut:]
    assert (found, reader.refused, reader.skipped) == (frames, 0, 0)


@given(st.binary(max_size=60), FRAMES)
def test_behind_any_bytes_the_second_frame_is_found_at_the_latest(garbage: bytes, frame: ImuFrame) -> None:
    # Bytes that look like the begin of a frame may take the first one's place until they are refused.
    reader = FrameReader()
    found = list(reader.receive(garbage + encoded(frame) * 3))
    assert frame in found
    assert len(found) <= 4


def test_a_damaged_frame_is_dropped_and_counted_and_the_next_one_found() -> None:
    reader, data = FrameReader(), bytearray(encoded(GOLDEN[0][1]))
    data[10] ^= 0x40
    found = list(reader.receive(bytes(data) + encoded(GOLDEN[1][1])))
    assert found == [GOLDEN[1][1]]
    assert (reader.refused, reader.skipped) == (1, LENGTH)


def test_a_sync_within_a_damaged_frame_hides_nothing() -> None:
    whole = encoded(ImuFrame(1, 0, 0, (0x5AA5, 0, 0), (0, 0, 0)))
    assert whole.count(SYNC) == 2
    reader = FrameReader()
    # The first byte is lost, so that the value's bytes are the first sync on the line.
    assert list(reader.receive(whole[1:] + encoded(GOLDEN[0][1]) * 2)) == [GOLDEN[0][1]] * 2
    assert reader.refused == 1


def test_half_a_sync_waits_for_the_other_half() -> None:
    reader, data = FrameReader(), encoded(GOLDEN[0][1])
    assert list(reader.receive(b"\x00" + data[:1])) == []
    assert list(reader.receive(data[1:])) == [GOLDEN[0][1]]
    assert reader.skipped == 1


def test_half_a_frame_is_forgotten_with_its_cable() -> None:
    reader, data = FrameReader(), encoded(GOLDEN[0][1])
    assert list(reader.receive(data[:12])) == []
    reader.flush()
    assert list(reader.receive(data)) == [GOLDEN[0][1]]


def test_a_frame_as_text() -> None:
    line = ImuLine()
    frame = ImuFrame(7, int(Status.FAILED | Status.RATE_CLIPPED), 1000, (0, -4096, 8192), (131, 0, 0))
    assert line.read("imu", Packet("imu", 0, encoded(frame))) == (
        "frame 7 at 1000 ms: +0.000 -0.500 +1.000 g, +2.00 +0.00 +0.00 deg/s, failed, rate clipped"
    )
    assert line.read("imu", Packet("imu", 0, b"abc")) == "3 bytes outside frames"
    assert line.read("imu", Packet("imu", 0, SYNC)) == "part of a line"
    assert line.read("bridge", Packet("imu", 0, b"abc")) == f"{UNREAD}: 3 bytes"
