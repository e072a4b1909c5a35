"""Recordings of CAN buses in the formats of other tools, by a file's suffix.

`.asc` and `.blf` are Vector's, `.trc` is PEAK's; `runtime.can_file_writer` writes them for `--record`.
`.mcap` is that of `firmware_bridge.mcap_file`. candump's log is read elsewhere, without a library.
"""

import io
import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import IO, TYPE_CHECKING, Final, TypeAlias

from firmware_bridge.extras import ExtraMissingError, from_extras
from firmware_bridge.mcap_file.channels import SUFFIX as MCAP
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import EPOCH, RecordingError
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import EXTENDED, REMOTE

if TYPE_CHECKING:
    import can

Note: TypeAlias = Callable[[str], None]
"""Takes a remark on a recording that is read all the same."""

OF_FRAMES: Final = (".asc", ".blf", ".trc")
"""Formats that hold CAN frames, and nothing else of a run."""
SUFFIXES: Final = (*OF_FRAMES, MCAP)
HEADER_END: Final = "no internal events logged\n"
DAYS: Final = 1e8
"""Seconds; an instant below counts from the begin of the recording, and one above from 1970."""
FROM_ITS_BEGIN: Final[Nanoseconds] = 100_000_000 * SECOND
"""Start instant of such a recording: its real one is unknown, and it was not on the bench's epoch."""


def is_foreign(path: Path) -> bool:
    """Return whether a file's name is that of another tool's recording."""
    return path.suffix.lower() in SUFFIXES


def _unnoted(_remark: str) -> None:
    """Take no notice."""


def frames(path: Path, note: Note = _unnoted) -> Iterator[tuple[Nanoseconds, str, Packet]]:
    """Yield instant, channel and frame of each message; error frames are left out, those of MCAP aside.

    RecordingError where the file is none of its format, or its extra is missing; OSError where it cannot be
    read.
    """
    if path.suffix.lower() == MCAP:
        found: Iterator[tuple[Nanoseconds, str, Packet]] = mcap_reader().frames(path, note)
        return found
    return _of_another_tool(path)


def mcap_reader() -> ModuleType:
    """Return `firmware_bridge.mcap_file.reader`; RecordingError where its extra is missing."""
    try:
        with from_extras():
            from firmware_bridge.mcap_file import reader  # noqa: PLC0415 - it needs an extra
    except ExtraMissingError as error:
        raise RecordingError(str(error)) from None
    return reader


def _of_another_tool(path: Path) -> Iterator[tuple[Nanoseconds, str, Packet]]:
    # 0.1 s, which no one needs whose recordings are candump's.
    import can  # noqa: PLC0415 - see above
    from can.io.blf import BLFParseError  # noqa: PLC0415 - see above

    readers = {".asc": can.ASCReader, ".blf": can.BLFReader, ".trc": can.TRCReader}
    suffix = path.suffix.lower()
    try:
        # Opened here: python-can leaves a file open that it cannot read.
        with path.open("rb" if suffix == ".blf" else "r") as file:
            opened = _with_header(file) if suffix == ".asc" else file
            for message in readers[suffix](opened):
                if not message.is_error_frame:
                    yield _instant(message.timestamp), _channel(message.channel), _packet(message)
    except (
        can.CanError,
        BLFParseError,
        ValueError,
        LookupError,
        TypeError,
        struct.error,
        zlib.error,
    ) as error:
        why = " ".join(str(error).split()) or type(error).__name__
        raise RecordingError(f"no recording of the format {path.suffix}: {why}") from None


def _with_header(file: IO[str]) -> IO[str]:
    """End the header of an .asc file where its first message begins.

    python-can takes the line for it that follows the comments: in BusMaster's files that is a message.
    """
    head: list[str] = []
    for line in file:
        if line[:1].isdigit() or line[:1].isspace():
            return io.StringIO("".join((*head, HEADER_END, line, *file)))
        head.append(line)
    return io.StringIO("".join(head))


def _instant(stamp: float) -> Nanoseconds:
    """Return an instant, rounded to microseconds; what counts from its own begin is none of the bench's."""
    if stamp < DAYS:
        return FROM_ITS_BEGIN + round(stamp * 1e6) * MICROSECOND
    return round(stamp * 1e6) * MICROSECOND - EPOCH


def _channel(channel: object) -> str:
    """Return the bus as candump would call it; a name stays."""
    return channel if isinstance(channel, str) else f"can{channel or 0}"


def _packet(message: "can.Message") -> Packet:
    address = message.arbitration_id | (EXTENDED if message.is_extended_id else 0)
    if message.is_remote_frame:
        return Packet(CAN, address | REMOTE, bytes(message.dlc))
    return Packet(CAN, address, bytes(message.data))
