"""Reader of a recording in MCAP: its frames, the bytes of its lines, its datagrams, its attachments.

It reads what another writer has made of the same schemas, compressed or not. A file whose end is missing, as
after a loss of power, is read up to its last whole chunk.
"""

import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final, TypeAlias
from zlib import error as ZlibError  # noqa: N812 - a class with a lower-case name

from google.protobuf.message import DecodeError
from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import CRCValidationError, StreamReader

from firmware_bridge.mcap_file.channels import DRIVE_STATE, FOXGLOVE, OWN
from firmware_bridge.mcap_file.schemas import foxglove, own
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction, RecordingError
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE
from firmware_bridge.wire.internet import number_of

Note: TypeAlias = Callable[[str], None]
"""Takes a remark on a recording that is read all the same."""
Chunk: TypeAlias = tuple[Nanoseconds, Direction, Packet]
"""Bytes of a serial line, or a datagram, as `firmware_bridge.recording.parse_chunk` returns them."""
MAGIC: Final = b"\x89MCAP0\r\n"
LARGEST: Final = 1 << 30
"""No record of a recording is larger, in bytes: a length beyond is damage."""
CUT: Final = "its end is cut off"
_BROKEN: Final = (
    *(McapError, CRCValidationError, DecodeError, ZlibError, struct.error),
    *(ValueError, LookupError, EOFError, RuntimeError, MemoryError),
)
"""Errors of the library and of its decompressors for a damaged file."""


def frames(path: Path, note: Note) -> Iterator[tuple[Nanoseconds, str, Packet]]:
    """Yield instant, bus and frame, in the order of the file; error reports with their flag.

    RecordingError where the file is no MCAP file, is damaged, or is cut off before its first record; OSError.
    """
    for at, message in _messages(path, "CanFrame", note):
        address, payload = message.id, message.data
        if message.extended or message.remote or message.error:
            address |= EXTENDED if message.extended else 0
            address |= ERROR if message.error else 0
            if message.remote:
                address, payload = address | REMOTE, bytes(min(message.requested, 8))
        yield at, message.bus, Packet(CAN, address, payload)


def chunks(path: Path, note: Note) -> Iterator[Chunk]:
    """Yield the bytes of serial lines, in the order of the file; RecordingError as `frames`, OSError."""
    for at, message in _messages(path, "SerialChunk", note):
        direction = Direction.SENT if message.sent else Direction.RECEIVED
        yield at, direction, Packet(message.link, 0, message.data)


def datagrams(path: Path, note: Note) -> Iterator[Chunk]:
    """Yield datagrams, in the order of the file, with the number of their place; RecordingError, OSError."""
    for at, message in _messages(path, "Datagram", note):
        direction = Direction.SENT if message.sent else Direction.RECEIVED
        yield at, direction, Packet(message.link, _place(message.place), message.data)


def _place(text: str) -> int:
    """Return the number of a place that `wire.internet.place_of` has written."""
    host, _, port = text.rpartition(":")
    try:
        return number_of(host.strip("[]"), int(port)) if text else 0
    except ValueError:
        raise RecordingError(f"{text!r:.80} is no place of a datagram") from None


def messages(path: Path, note: Note) -> Iterator[tuple[Nanoseconds, str, Any]]:
    """Yield instant, topic and decoded message of every channel with a schema of a recording's, in order.

    RecordingError as `frames`, OSError.
    """
    schemas = {
        one.name: one
        for one in (*map(own, (*OWN.values(), DRIVE_STATE)), *map(foxglove, set(FOXGLOVE.values())))
    }
    named: dict[int, str] = {}
    topics: dict[int, tuple[str, Any]] = {}
    for record in _records(path, note):
        match record:
            case Schema(id=number, name=name):
                named[number] = name
            case Channel(id=number, schema_id=schema_id, topic=topic) if named.get(schema_id) in schemas:
                topics[number] = topic, schemas[named[schema_id]].message
            case Message(channel_id=channel, log_time=at, data=data) if channel in topics:
                topic, message = topics[channel]
                try:
                    yield at, topic, message.FromString(data)
                except DecodeError as error:
                    raise RecordingError(f"a message of {topic} is damaged: {error}") from None


def metadata(path: Path) -> dict[str, str]:
    """Return what a recording states of itself: robot, mission, seed; RecordingError, OSError."""
    found: dict[str, str] = {}
    for record in _records(path, lambda _note: None):
        if isinstance(record, Metadata):
            found |= record.metadata
        elif isinstance(record, Message):
            break
    return found


def attachments(path: Path) -> dict[str, bytes]:
    """Return the attached files by their names; RecordingError as `frames`, OSError."""
    found = (record for record in _records(path, lambda _note: None) if isinstance(record, Attachment))
    return {record.name: record.data for record in found}


def _messages(path: Path, name: str, note: Note) -> Iterator[tuple[Nanoseconds, Any]]:
    """Yield instant and decoded message of each channel with this schema, by whatever topic."""
    schema, numbers, wanted = own(name), set[int](), set[int]()
    for record in _records(path, note):
        match record:
            case Schema(id=number, name=schema.name):
                numbers.add(number)
            case Channel(id=number, schema_id=schema_id) if schema_id in numbers:
                wanted.add(number)
            case Message(channel_id=channel, log_time=at, data=data) if channel in wanted:
                try:
                    yield at, schema.message.FromString(data)
                except DecodeError as error:
                    raise RecordingError(f"a message of {schema.name} is damaged: {error}") from None


def _records(path: Path, note: Note) -> Iterator[McapRecord]:
    """Yield the records of a file, those of its chunks in their place."""
    size = path.stat().st_size
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise RecordingError("it does not begin like an MCAP file; record it again")
        file.seek(max(size - len(MAGIC), 0))
        whole = size > len(MAGIC) and file.read() == MAGIC
        file.seek(0)
        found = False
        try:
            for record in StreamReader(file, validate_crcs=True, record_size_limit=LARGEST).records:
                found = found or isinstance(record, Message)
                yield record
        except _BROKEN as error:
            if whole:
                raise RecordingError(f"it is damaged ({_one_line(error)}); record it again") from None
            if not found:
                raise RecordingError(f"{CUT} before its first message; record it again") from None
            note(CUT)


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__
