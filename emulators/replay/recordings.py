"""Recordings from files: CAN logs, lines of bytes, a telemetry log; each packet with its place.

Compressed ones are read as they are (`.gz`, `.xz`). Instants count from the start of the recording: that of
the bench is the start of its virtual run, any other one starts where its first frame began.
"""

import lzma
import zlib
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Final, Protocol, TypeAlias

from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.recording import (
    CutOffError,
    Direction,
    RecordingError,
    is_chunk,
    parse_candump,
    parse_chunk,
    parse_tlog,
)
from firmware_bridge.runtime import can_files
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, frame_bits

BEGIN: Final = b"("
"""First byte of each line of a log."""
_GZIP: Final = 16 + zlib.MAX_WBITS


class _Unpacker(Protocol):
    @property
    def eof(self) -> bool: ...

    def decompress(self, data: bytes, /) -> bytes: ...


RESOLUTION: Final[Nanoseconds] = MICROSECOND
"""Resolution of the instants of frames and messages, which are cut and not rounded."""
TELEMETRY: Final = ".tlog"
BENCH_WITHIN: Final[Nanoseconds] = 60 * SECOND
"""Limit after the epoch by which the bench's own recordings begin, a board's once it has booted.

No real clock shows that day any more.
"""
_UNPACKERS: Final[Mapping[str, Callable[[], _Unpacker]]] = MappingProxyType(
    {".gz": lambda: zlib.decompressobj(_GZIP), ".xz": lzma.LZMADecompressor}
)
LINES: Final = frozenset(("serial", "capture"))
"""Names of files of lines, before their suffixes."""
_SHOWN: Final = 80
"""Number of characters shown of a line that cannot be read."""


Frame: TypeAlias = tuple[str, Nanoseconds, str, Packet]
"""Place in the recording, instant, bus and frame."""


class RecordingFileError(Exception):
    """A recording that cannot be used: which file, where in it, and what is wrong."""


@dataclass(frozen=True, slots=True)
class RecordedPacket:
    """One packet of a recording; it had wholly arrived at `at`."""

    at: Nanoseconds
    packet: Packet
    where: str
    """File and line, or file and message."""
    direction: Direction | None = None
    """Direction in which it passed the bridge, where the recording has it."""


@dataclass(frozen=True, slots=True)
class Recording:
    """The packets of one file, in order."""

    name: str
    entries: tuple[RecordedPacket, ...]
    origin: Nanoseconds = 0
    """The instant from which those of the packets count, from the bench's epoch on."""

    @property
    def virtual(self) -> bool:
        """True if it is the bench's own: its instants count from the start of the run already."""
        return 0 <= self.entries[0].at + self.origin < BENCH_WITHIN

    def start(self, bit_time: Nanoseconds) -> Nanoseconds:
        """Return the instant from which its instants should count."""
        first = self.entries[0]
        # Recorded when it had arrived: it began by its own length earlier.
        return 0 if self.virtual else first.at - duration_of(first.packet, bit_time)

    def since(self, origin: Nanoseconds) -> "Recording":
        """Return the same packets with instants that count from `origin`."""
        moved = tuple(replace(one, at=one.at - origin) for one in self.entries)
        return Recording(self.name, moved, self.origin + origin)


def is_telemetry(path: Path) -> bool:
    """Return whether a file's name is that of a telemetry log, compressed or not."""
    return TELEMETRY in path.suffixes[-2:]


def read_can(path: Path, channel: str | None) -> Recording:
    """Read a CAN log; RecordingFileError. Reports of the recorder's own controller are left out.

    `channel` chooses one where frames of several buses stand in the log.
    """
    found: dict[str, list[RecordedPacket]] = {}
    for where, at, bus, packet in _foreign(path) if can_files.is_foreign(path) else _candump(path):
        if not packet.address & ERROR:
            found.setdefault(bus, []).append(RecordedPacket(at, packet, where))
    if not found:
        raise RecordingFileError(f"{path.name}: holds no CAN frame")
    buses = ", ".join(sorted(found))
    if channel is not None and channel not in found:
        raise RecordingFileError(f"{path.name}: holds no frame of '{channel}', but of {buses}")
    if channel is None and len(found) > 1:
        raise RecordingFileError(f"{path.name}: holds frames of {buses}; choose one with --channel")
    return _in_order(path.name, found[channel] if channel else next(iter(found.values())))


def _candump(path: Path) -> Iterator[Frame]:
    for number, line, whole in _lines(path):
        if line.strip():
            where = f"{path.name}, line {number}"
            try:
                yield where, *parse_candump(line)
            except RecordingError:
                # The last line may be cut off, as after a loss of power: it is left out.
                if not whole:
                    return
                raise RecordingFileError(
                    f"{where}: no line of a candump log, as '(12.345678) can0 123#DEADBEEF': {_shown(line)}"
                ) from None


def _foreign(path: Path) -> Iterator[Frame]:
    try:
        for number, frame in enumerate(can_files.frames(path), start=1):
            yield f"{path.name}, frame {number}", *frame
    except RecordingError as error:
        raise RecordingFileError(f"{path.name}: {error}") from None
    except OSError as error:
        raise RecordingFileError(f"{path}: cannot be read: {error.strerror}") from None


def is_lines(path: Path) -> bool:
    """Return whether a file is a log of serial lines or of cameras, by its name or its first line."""
    if is_telemetry(path) or can_files.is_foreign(path) or not path.exists():
        return False
    return path.name.split(".")[0] in LINES or is_chunk(_content(path).lstrip()[:_SHOWN].decode("latin-1"))


def read_lines(path: Path) -> Recording:
    """Read what serial lines or cameras have carried; RecordingFileError."""
    entries = []
    for number, line, whole in _lines(path):
        if not line.strip():
            continue
        where = f"{path.name}, line {number}"
        try:
            at, direction, packet = parse_chunk(line)
        except RecordingError as error:
            if not whole:
                break
            raise RecordingFileError(f"{where}: {error}") from None
        entries.append(RecordedPacket(at, packet, where, direction))
    if not entries:
        raise RecordingFileError(f"{path.name}: holds nothing that a line has carried")
    return _in_order(path.name, entries)


def read_telemetry(path: Path) -> Recording:
    """Read a telemetry log; RecordingFileError."""
    entries: list[RecordedPacket] = []
    try:
        for at, message in parse_tlog(_content(path)):
            where = f"{path.name}, message {len(entries) + 1}"
            entries.append(RecordedPacket(at, Packet(OPERATOR, 0, message), where))
    except RecordingError as error:
        # A log that was cut off is good up to its last whole message.
        if not (entries and isinstance(error, CutOffError)):
            raise RecordingFileError(f"{path.name}: {error}") from None
    if not entries:
        raise RecordingFileError(f"{path.name}: holds no MAVLink message")
    return _in_order(path.name, entries)


def duration_of(packet: Packet, bit_time: Nanoseconds) -> Nanoseconds:
    """Return how long a packet takes on its link: a frame its bits, a datagram nothing."""
    return frame_bits(packet.address, packet.payload) * bit_time if packet.link == CAN else 0


def cut_off(path: Path) -> str | None:
    """Return the report of a recording that is cut off, as after a loss of power; None for others."""
    if can_files.is_foreign(path):
        return None
    content, whole = _unpacked(path)
    left_out = ""
    if is_telemetry(path):
        try:
            deque(parse_tlog(content), maxlen=0)
        except CutOffError:
            left_out = "its last message"
        except RecordingError:
            return None
    elif content and not content.endswith(b"\n"):
        last = content.rpartition(b"\n")[2]
        cut = last.startswith(BEGIN) and not _reads(last.decode("latin-1"))
        left_out = f"line {len(content.splitlines())}" if cut else ""
    if whole and not left_out:
        return None
    return f"{path.name}: its end is cut off" + (f"; {left_out} is left out" if left_out else "")


def _reads(line: str) -> bool:
    for parse in (parse_candump, parse_chunk):
        with suppress(RecordingError):
            parse(line)
            return True
    return not line.strip()


def _content(path: Path) -> bytes:
    """Return a file's bytes as they were before they were compressed, as far as they are there."""
    return _unpacked(path)[0]


def _unpacked(path: Path) -> tuple[bytes, bool]:
    """Return a file's bytes, and whether it has its end: no zeros, which a loss of power leaves there."""
    whole = True
    try:
        content = path.read_bytes()
        if path.suffix in _UNPACKERS:
            # Not `gzip.open`: a stream that is cut off gives what it has, and no error.
            unpacker = _UNPACKERS[path.suffix]()
            content = unpacker.decompress(content)
            whole = unpacker.eof
    except (zlib.error, lzma.LZMAError) as error:
        raise RecordingFileError(f"{path.name}: cannot be unpacked: {error}") from None
    except OSError as error:
        raise RecordingFileError(f"{path}: cannot be read: {error.strerror}") from None
    if is_telemetry(path):
        return content, whole
    # A loss of power leaves zeros at the end of a file that was not yet on the disk.
    kept = content.rstrip(b"\0")
    return kept, whole and len(kept) == len(content)


def _lines(path: Path) -> Iterator[tuple[int, str, bool]]:
    """Yield number and text of each line, and whether it cannot be the begin of one that was cut off.

    RecordingFileError where bytes are no text.
    """
    lines = _content(path).split(b"\n")
    for number, line in enumerate(lines, start=1):
        try:
            # A whole file ends with a line feed, so that the last of these lines is empty.
            last = 1 < number == len(lines) and line.startswith(BEGIN)
            yield number, line.decode("ascii").rstrip("\r"), not last
        except UnicodeDecodeError:
            raise RecordingFileError(
                f"{path.name}, line {number}: no text; a CAN log has a line for each frame,"
                " as `candump -l` writes it"
            ) from None


def _in_order(name: str, entries: list[RecordedPacket]) -> Recording:
    for before, after in pairwise(entries):
        if after.at < before.at:
            raise RecordingFileError(f"{after.where}: its instant is before that of the one above it")
    return Recording(name, tuple(entries))


def _shown(line: str) -> str:
    return repr(line if len(line) <= _SHOWN else line[:_SHOWN] + "...")
