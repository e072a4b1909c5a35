"""Chunks of a recording of serial lines: the log of a run, of the bridge, or of a device."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Final

from firmware_bridge.explain.source import COMPRESSED, RUN_LOG, SERIAL_LOG, Note, UnreadableError
from firmware_bridge.mcap_file.channels import SUFFIX as MCAP
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction, RecordingError, is_chunk, parse_chunk, side_of
from firmware_bridge.runtime.can_files import mcap_reader
from firmware_bridge.units import Nanoseconds

BRIDGE: Final = "bridge"
"""Name of the end that sends requests."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes of one end of a line."""

    at: Nanoseconds
    link: str
    by_device: bool
    payload: bytes
    spoken: str | None
    """Protocol, where the device itself has recorded it."""


def line_log(path: Path) -> Path | None:
    """Return the recording of serial lines that a path names; None where it names another recording."""
    if path.is_dir():
        if _has_content(path / RUN_LOG) or any(_has_content(path / f"{RUN_LOG}{it}") for it in COMPRESSED):
            return None
        return path / SERIAL_LOG if _has_content(path / SERIAL_LOG) else None
    if path.suffix.lower() == MCAP:
        return path if _has_only_lines(path) else None
    try:
        with _opener(path)(path, "rt", encoding="ascii", errors="replace") as lines:
            return path if is_chunk(lines.readline(200)) else None
    except (OSError, EOFError):
        return None


def beside(path: Path) -> Iterator[str]:
    """Yield a note on the lines of a folder whose bus is explained."""
    if path.is_dir() and line_log(path) is None and _has_content(path / SERIAL_LOG):
        yield f"{path / SERIAL_LOG} is not explained beside {RUN_LOG}; name it for itself"


def _has_content(path: Path) -> bool:
    return path.is_file() and path.stat().st_size > 0


def _has_only_lines(path: Path) -> bool:
    """Return whether a recording in MCAP has bytes of lines and no frames; False where it cannot be read."""
    try:
        reader = mcap_reader()
        return not any(reader.frames(path, _unnoted)) and any(reader.chunks(path, _unnoted))
    except (OSError, RecordingError):
        return False


def _unnoted(_remark: str) -> None:
    """Take no notice."""


def _opener(path: Path) -> Callable[..., IO[str]]:
    return COMPRESSED.get(path.suffix, open)


def chunks(path: Path, note: Note) -> Iterator[Chunk]:
    """Yield the chunks of a recording; UnreadableError for a line that is none."""
    for at, direction, packet in (_of_mcap if path.suffix.lower() == MCAP else _of_text)(path, note):
        name, spoken = side_of(packet.link)
        # SENT is the end that has recorded: the device in its own log, the bridge in all others.
        by_device = (direction is Direction.SENT) == (spoken is not None)
        yield Chunk(at, name, by_device, packet.payload, spoken)


def _of_mcap(path: Path, note: Note) -> Iterator[tuple[Nanoseconds, Direction, Packet]]:
    try:
        yield from mcap_reader().chunks(path, lambda text: note(f"{path}: {text}"))
    except RecordingError as error:
        raise UnreadableError(f"{path}: cannot be read: {error}") from None


def _of_text(path: Path, note: Note) -> Iterator[tuple[Nanoseconds, Direction, Packet]]:
    with _opener(path)(path, "rt", encoding="ascii", errors="replace") as lines:
        for number, line in enumerate(lines, start=1):
            try:
                yield parse_chunk(line.rstrip("\r\n"))
            except RecordingError as error:
                if not line.strip("\0 \t\r\n"):
                    continue
                if line.startswith("(") and not line.endswith("\n") and number > 1:
                    note(f"{path}: its end is cut off; line {number} is left out")
                    return
                raise UnreadableError(f"{path}, line {number}: {error}") from None
