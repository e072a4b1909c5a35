"""Recordings: candump's log, MAVLink's telemetry log, and a node that is watched."""

import io
import struct
import sys
from pathlib import Path

import can
import hypothesis.strategies as st
import pytest
from hypothesis import given
from pymavlink import mavutil
from pymavlink.dialects.v20 import common as mavlink

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.recording import (
    EPOCH,
    Direction,
    Recorded,
    RecordingError,
    candump_line,
    chunk_line,
    is_chunk,
    mavlink_messages,
    parse_candump,
    parse_chunk,
    parse_tlog,
    tlog_records,
)
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE
from firmware_bridge.wire.internet import number_of

addresses = st.one_of(
    st.integers(0, 0x7FF), st.integers(0, 0x1FFF_FFFF).map(lambda number: number | EXTENDED)
)
frames = st.one_of(
    st.builds(lambda address, content: Packet("can", address, content), addresses, st.binary(max_size=8)),
    st.builds(
        lambda address, length: Packet("can", address | REMOTE, bytes(length)), addresses, st.integers(0, 8)
    ),
)


@pytest.mark.parametrize(
    ("at", "address", "content", "line"),
    [
        (0, 0x123, "DEADBEEF", "(1577836800.000000) vcan0 123#DEADBEEF"),
        (12_345_678_999, 0x080, "", "(1577836812.345678) vcan0 080#"),
        (SECOND, 0x123 | REMOTE, "00000000", "(1577836801.000000) vcan0 123#R4"),
        (SECOND, 0x123 | REMOTE, "", "(1577836801.000000) vcan0 123#R"),
        (SECOND, 0x12 | EXTENDED, "01", "(1577836801.000000) vcan0 00000012#01"),
        (SECOND, 0x1FFFFFFF | EXTENDED | REMOTE, "00", "(1577836801.000000) vcan0 1FFFFFFF#R1"),
        (SECOND, 0x40 | ERROR, "0000000000000000", "(1577836801.000000) vcan0 20000040#0000000000000000"),
    ],
)
def test_frames_in_the_form_of_candump(at: Nanoseconds, address: int, content: str, line: str) -> None:
    packet = Packet("can", address, bytes.fromhex(content))
    assert candump_line(at, packet) == line
    assert parse_candump(line) == (at // MICROSECOND * MICROSECOND, "vcan0", packet)


hosts = st.ip_addresses().map(str)
places = st.one_of(st.just(0), st.builds(number_of, hosts, st.integers(1, 65535)))


@given(
    st.integers(0, 10**18),
    st.sampled_from(["board", "arm", "drives"]),
    st.sampled_from(Direction),
    places,
    st.binary(max_size=20),
)
def test_bytes_come_back_from_their_line(
    at: Nanoseconds, link: str, way: Direction, place: int, content: bytes
) -> None:
    packet = Packet(link, place, content)
    line = chunk_line(at, link, way, packet)
    assert is_chunk(line)
    assert parse_chunk(line) == (at, way, packet), "to the nanosecond"
    assert parse_chunk(line.lower().replace(" r", " R", 1).replace(" t", " T", 1))[2].payload == content


@pytest.mark.parametrize(
    ("line", "meant"),
    [
        ("", False),
        ("(1.000000) can0 123#00 T", False),
        ("(1.000000) board T 6", True),
        ("(1.000000000) board T 626", True),
        ("(1.000000000) board X 62", False),
        ("(1.0) board R 62", True),
        ("(1.000000000) cameras R 10.0.0.1:0 62", True),
        ("(1.000000000) cameras R 10.0.0.1.1:1511 62", True),
        ("(1.000000000) cameras R 10.0.0.1:1511 6G", True),
        ("(1.000000000) " + 999 * "x", False),
    ],
)
def test_what_is_no_line_of_bytes_is_refused_with_what_one_is_like(line: str, *, meant: bool) -> None:
    assert is_chunk(line) is meant
    with pytest.raises(RecordingError) as refused:
        parse_chunk(line)
    assert "\n" not in str(refused.value)
    assert len(str(refused.value)) < 200


def test_instants_of_microseconds_are_taken_too() -> None:
    assert parse_chunk("(1577836800.000007) board R 62")[0] == 7 * MICROSECOND


@given(st.integers(0, 10**15), frames)
def test_a_frame_comes_back_from_its_line(at: Nanoseconds, packet: Packet) -> None:
    line = candump_line(at, packet, "can1", epoch=0)
    assert parse_candump(line + "\n", epoch=0) == (at // MICROSECOND * MICROSECOND, "can1", packet)


@given(frames)
def test_python_can_reads_the_same_frame(packet: Packet) -> None:
    (message,) = can.CanutilsLogReader(io.StringIO(candump_line(0, packet) + "\n"))
    address = message.arbitration_id | (EXTENDED if message.is_extended_id else 0)
    assert address | (REMOTE if message.is_remote_frame else 0) == packet.address
    assert message.dlc == len(packet.payload)
    assert message.is_remote_frame or bytes(message.data) == packet.payload
    assert message.timestamp == EPOCH / SECOND


@pytest.mark.parametrize(
    "line", ["", "123#00", "(1.0) can0 123#00", "(1.000000) can0 123#0", "(1.000000) can0 123##100", "x" * 99]
)
def test_what_is_no_line_of_a_log_is_refused(line: str) -> None:
    with pytest.raises(RecordingError, match="not a line of a candump log"):
        parse_candump(line)


def test_a_line_with_a_direction_is_read_too() -> None:
    assert parse_candump("(1577836800.000001) can0 123#00 R")[2] == Packet("can", 0x123, b"\0")


def messages(count: int) -> list[bytes]:
    sender = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    return [
        mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GROUND_ROVER, 0, 0, number, 4, 3).pack(
            sender, force_mavlink1=number % 2 == 1
        )
        for number in range(count)
    ]


def test_a_telemetry_log_is_read_by_pymavlink(tmp_path: Path) -> None:
    log = b"".join(tlog_records(k * SECOND, message) for k, message in enumerate(messages(4)))
    (tmp_path / "operator.tlog").write_bytes(log)
    # Its reader closes no file; that is its affair.
    reader = mavutil.mavlink_connection(str(tmp_path / "operator.tlog"))
    try:
        read = [reader.recv_msg() for _ in range(4)]
        assert [message.custom_mode for message in read] == [0, 1, 2, 3]
        assert [message._timestamp - EPOCH / SECOND for message in read] == [0, 1, 2, 3]  # noqa: SLF001 - its name
        assert reader.recv_msg() is None
    finally:
        reader.close()


def test_each_message_of_a_datagram_is_a_record_and_other_bytes_are_left_out() -> None:
    one, two, three = messages(3)
    datagram = b"\x00" + one + two + b"garbage" + three + b"\xfd\x09"
    assert list(mavlink_messages(datagram)) == [one, two, three]
    stamp = struct.pack(">Q", (EPOCH + 5 * SECOND) // 1000)
    assert tlog_records(5 * SECOND, datagram) == stamp + one + stamp + two + stamp + three
    assert list(parse_tlog(tlog_records(5 * SECOND, datagram))) == [
        (5 * SECOND, each) for each in (one, two, three)
    ]


def test_a_signed_message_keeps_its_signature() -> None:
    signed = bytes([0xFD, 1, 1, 0, 0, 1, 1, 0, 0, 0]) + bytes(1 + 2 + 13)
    assert list(mavlink_messages(signed)) == [signed]


@pytest.mark.parametrize("cut", [1, 8, 12, 20])
def test_a_log_that_is_cut_off_is_refused(cut: int) -> None:
    whole = tlog_records(0, messages(1)[0])
    with pytest.raises(RecordingError, match="byte 8 of"):
        list(parse_tlog(whole[:cut]))


class Answering:
    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        return Reaction((Packet("can", packet.address + 1, b""),), now + 5)

    def wake(self, now: Nanoseconds) -> Reaction:
        return Reaction((Packet("can", 7, b""),), now + 9)


class Stopping(Answering):
    def stop(self, now: Nanoseconds) -> Reaction:
        return Reaction((Packet("can", 9, b""),), now + 1)


def test_a_recorder_notes_everything_and_changes_nothing() -> None:
    noted: list[tuple[Nanoseconds, Direction, int]] = []
    node = Recorded(Stopping(), lambda now, way, packet: noted.append((now, way, packet.address)))
    assert node.wake(0) == Answering().wake(0)
    assert node.receive(Packet("can", 3, b""), 4) == Answering().receive(Packet("can", 3, b""), 4)
    assert node.stop(6) == Stopping().stop(6)
    assert noted == [
        (0, Direction.SENT, 7),
        (4, Direction.RECEIVED, 3),
        (4, Direction.SENT, 4),
        (6, Direction.SENT, 9),
    ]


def test_a_recorded_node_that_cannot_be_stopped_is_done_at_once() -> None:
    assert Recorded(Answering(), lambda *_: sys.exit()).stop(5) == Reaction()
