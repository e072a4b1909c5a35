"""What is written is read again; damage and a missing end are reported, and raise nothing else."""

import io
from pathlib import Path

import hypothesis.strategies as st
import pytest
from hypothesis import example, given
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from firmware_bridge.mcap_file.reader import CUT, attachments, chunks, datagrams, frames
from firmware_bridge.mcap_file.rows import DriveRow, EventKind, EventRow, Joint
from firmware_bridge.mcap_file.schemas import own
from firmware_bridge.mcap_file.writer import RecordingWriter
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction, RecordingError
from firmware_bridge.units import SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE
from firmware_bridge.wire.internet import number_of
from hil_tests.lanes import examples
from hil_tests.unit.mcap_file.recorded_run import rows

FRAMES = (
    Packet(CAN, 0x701, b"\0"),
    Packet(CAN, 0x181, bytes(range(8))),
    Packet(CAN, 0x12345678 | EXTENDED, b"\xff"),
    Packet(CAN, 0x701 | REMOTE, b"\0"),
    Packet(CAN, 0x12 | EXTENDED | REMOTE, bytes(8)),
    Packet(CAN, 0x40 | ERROR, bytes(8)),
    Packet(CAN, 0x80, b""),
)
STEP: Nanoseconds = 111_000


def written(packets: tuple[Packet, ...] = FRAMES, every: int = 1) -> bytes:
    """Return a recording of frames on can0, its chunks as long as `every` frames."""
    file = io.BytesIO()
    writer = RecordingWriter(file, {"robot": "rars"})
    for number, packet in enumerate(packets):
        writer.frame(number * STEP, "can0", packet, sent=False)
        if number % every == 0:
            writer.flush()
    writer.finish()
    return file.getvalue()


def read(path: Path, data: bytes) -> tuple[list[tuple[Nanoseconds, str, Packet]], list[str]]:
    """Return the frames of a recording, and the notes on it."""
    path.write_bytes(data)
    notes: list[str] = []
    return list(frames(path, notes.append)), notes


ALL = [(number * STEP, "can0", packet) for number, packet in enumerate(FRAMES)]
WHOLE = written()


def test_each_kind_of_frame_is_read_as_it_was_written(tmp_path: Path) -> None:
    assert read(tmp_path / "a.mcap", WHOLE) == (ALL, [])


ADDRESSES = st.one_of(
    st.integers(0, 0x7FF), st.integers(0, 0x1FFF_FFFF).map(lambda number: number | EXTENDED)
)
ANY = st.one_of(
    st.builds(lambda address, content: Packet(CAN, address, content), ADDRESSES, st.binary(max_size=8)),
    st.builds(
        lambda address, length: Packet(CAN, address | REMOTE, bytes(length)), ADDRESSES, st.integers(0, 8)
    ),
)


@given(packets=st.lists(ANY, max_size=20).map(tuple), every=st.integers(1, 20))
def test_any_frames_are_read_as_they_were_written(
    packets: tuple[Packet, ...], every: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    found, notes = read(tmp_path_factory.getbasetemp() / "any.mcap", written(packets, every))
    assert ([packet for _, _, packet in found], notes) == (list(packets), [])


def test_a_file_without_its_end_is_read_as_far_as_it_goes_wherever_it_is_cut(tmp_path: Path) -> None:
    counts = set()
    for length in range(len(WHOLE)):
        try:
            found, notes = read(tmp_path / "cut.mcap", WHOLE[:length])
        except RecordingError as error:
            assert "\n" not in str(error)  # noqa: PT017 - most lengths raise nothing
            found, notes = [], [CUT]
        assert notes == [CUT]
        assert found == ALL[: len(found)]
        counts.add(len(found))
    assert counts == set(range(len(ALL) + 1))


# A bit of a payload: its chunk has a checksum, and protobuf would take it.
@example(at=WHOLE.index(bytes(range(8))) + 3, bit=1)
@given(at=st.integers(0, len(WHOLE) - 1), bit=st.integers(0, 7))
def test_a_bit_that_is_wrong_is_damage_or_concerns_no_frame(
    at: int, bit: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    data = bytearray(WHOLE)
    data[at] ^= 1 << bit
    try:
        found, _ = read(tmp_path_factory.getbasetemp() / "bit.mcap", bytes(data))
    except RecordingError:
        return
    assert [one for one in found if one not in ALL] == [], "no frame that was never on the bus"


@given(st.binary(max_size=examples(200)))
def test_any_bytes_behind_the_beginning_of_a_file_are_one_message(
    tmp_path_factory: pytest.TempPathFactory, tail: bytes
) -> None:
    with pytest.raises(RecordingError):
        read(tmp_path_factory.getbasetemp() / "tail.mcap", WHOLE[:8] + tail)


@pytest.mark.parametrize("compression", CompressionType)
def test_a_file_of_another_writer_is_read_compressed_or_not(
    compression: CompressionType, tmp_path: Path
) -> None:
    file, schema = io.BytesIO(), own("CanFrame")
    writer = Writer(file, compression=compression)
    writer.start()
    other = writer.register_schema("other", "protobuf", b"")
    number = writer.register_schema(schema.name, "protobuf", schema.descriptor)
    strange, known = (writer.register_channel(*one) for one in (("/x", "", other), ("/bus", "", number)))
    writer.add_message(strange, 1, b"\xff\xff", 1)
    writer.add_message(known, 2, schema.message(bus="b", id=0x80).SerializeToString(), 2)
    writer.finish()  # type: ignore[no-untyped-call] # the library's
    assert read(tmp_path / "other.mcap", file.getvalue()) == ([(2, "b", Packet(CAN, 0x80, b""))], [])


@pytest.mark.parametrize("place", ["nowhere", "127.0.0.1:0", "[::1]", "1.2.3.4:99999"])
def test_a_datagram_of_no_place_is_reported(place: str, tmp_path: Path) -> None:
    schema, path = own("Datagram"), tmp_path / "bad.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        number = writer.register_schema(schema.name, "protobuf", schema.descriptor)
        channel = writer.register_channel("/datagrams", "protobuf", number)
        writer.add_message(channel, 0, schema.message(link="x", place=place).SerializeToString(), 0)
        writer.finish()  # type: ignore[no-untyped-call] # the library's
    with pytest.raises(RecordingError, match="is no place of a datagram"):
        list(datagrams(path, lambda _note: None))


def test_datagrams_come_back_with_their_places(tmp_path: Path) -> None:
    path, places = tmp_path / "all.mcap", (0, number_of("192.168.1.10", 1511), number_of("fe80::1", 14550))
    with path.open("wb") as file:
        writer = RecordingWriter(file, {})
        for at, place in enumerate(places):
            writer.datagram(at, "cameras", Packet("cameras", place, bytes((at,))), sent=at == 1)
        writer.finish()
    assert list(datagrams(path, lambda _note: None)) == [
        (at, Direction.SENT if at == 1 else Direction.RECEIVED, Packet("cameras", place, bytes((at,))))
        for at, place in enumerate(places)
    ]


def test_a_message_that_is_damaged_is_reported(tmp_path: Path) -> None:
    file, schema = io.BytesIO(), own("CanFrame")
    writer = Writer(file)
    writer.start()
    number = writer.register_schema(schema.name, "protobuf", schema.descriptor)
    writer.add_message(writer.register_channel("/can/frames", "protobuf", number), 0, b"\x0a\xff", 0)
    writer.finish()  # type: ignore[no-untyped-call] # the library's
    with pytest.raises(RecordingError, match=r"a message of firmware_bridge\.recording\.CanFrame is damaged"):
        read(tmp_path / "bad.mcap", file.getvalue())


def test_bytes_datagrams_texts_states_and_files_are_what_was_given(tmp_path: Path) -> None:
    path = tmp_path / "all.mcap"
    with path.open("wb") as file:
        writer = RecordingWriter(file, {"seed": "7"})
        writer.chunk(1, "base~mw", b"\x01", sent=True)
        writer.datagram(2, "operator", Packet("operator", number_of("10.0.0.1", 14550), b"\xfd"), sent=False)
        for severity in range(8):
            writer.text(3 * SECOND + 4, severity, "operator", f"text {severity}")
        writer.drive(5, "/drive/1/state", DriveRow("left", "on", "operation enabled", "rad", position=0.0))
        writer.joints(6, [Joint("left", 1.5, -0.5)])
        writer.event(7, EventRow(EventKind.DISARMED))
        writer.attach("mission.toml", "text/plain", b"title")
        writer.finish()
    by_topic = {row.topic: row for row in rows(path)}
    assert list(chunks(path, lambda _note: None)) == [(1, Direction.SENT, Packet("base~mw", 0, b"\x01"))]
    datagram = by_topic["/datagrams"].message
    assert (datagram.place, datagram.data, datagram.sent) == ("10.0.0.1:14550", b"\xfd", False)
    texts = [row.message for row in rows(path, "/log")]
    assert [one.level for one in texts] == [5, 5, 5, 4, 3, 2, 2, 1]
    assert (texts[0].timestamp.seconds, texts[0].timestamp.nanos) == (3, 4)
    drive = by_topic["/drive/1/state"].message
    assert (drive.HasField("position"), drive.HasField("velocity")) == (True, False), "0 is a value"
    assert not drive.HasField("statusword")
    (joint,) = by_topic["/robot/joints"].message.joints
    assert (joint.name, joint.position, joint.velocity) == ("left", 1.5, -0.5)
    assert by_topic["/events"].message.since_ns == 7, "what has just begun has begun now"
    assert attachments(path) == {"mission.toml": b"title"}
    with path.open("rb") as file:
        reader = make_reader(file)
        header, (metadata,) = reader.get_header(), reader.iter_metadata()
    assert (header.library, header.profile) == ("firmware-bridge", ""), "no version, so that it never changes"
    assert metadata.metadata == {"format": "1", "seed": "7"}
