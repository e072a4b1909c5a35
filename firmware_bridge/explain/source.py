"""Frames of a recording: candump's log, a run's folder, other tools' formats, captures of a network tool.

A frame is a tuple, as a recording has a hundred thousand of them. Numbers of lines count from 1.
"""

import gzip
import lzma
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import IO, Final, TypeAlias

from firmware_bridge.explain import capture
from firmware_bridge.recording import EPOCH, RecordingError, is_chunk, parse_candump
from firmware_bridge.runtime import can_files
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE

Frame: TypeAlias = tuple[Nanoseconds, str, int, bytes]
"""Instant, bus, address with flags, payload."""
Note: TypeAlias = Callable[[str], None]
"""Takes a remark on a recording that is read all the same."""

RUN_LOG: Final = "can.log"
"""The bus of a run, in its folder."""
SERIAL_LOG: Final = "serial.log"
"""The serial lines of a run, in its folder: see `firmware_bridge.explain.line_source`."""
COMPRESSED: Final[Mapping[str, Callable[..., IO[str]]]] = {".gz": gzip.open, ".xz": lzma.open}
CAPTURES: Final = (".pcap", ".pcapng", ".cap")
_MICROSECONDS: Final = 8
"""Characters from the point to the end of a stamp of microseconds, bracket included."""
_SHORT: Final = 3
"""Digits of an identifier of 11 bits."""
_MOST: Final = 16
"""Digits of a payload."""
_SHOWN: Final = 4
"""Fields of a line as candump shows it on a screen: stamp, bus, identifier, length."""


class UnreadableError(Exception):
    """A recording that cannot be read: what, where, and what to do."""


def frames(path: Path, note: Note) -> Iterator[Frame]:
    """Yield the frames of a recording or of a run's folder; UnreadableError where there are none."""
    path = _of_run(path) if path.is_dir() else path
    try:
        first = _first(path)
        if first is None:
            raise UnreadableError(
                f"{path}: holds no frame: the file is empty; record a bus with `candump -L`"
            )
        yield from _opened(path, note)
    except (OSError, EOFError, lzma.LZMAError) as error:
        raise UnreadableError(f"{path}: cannot be read: {error}") from None
    except (RecordingError, capture.CaptureError) as error:
        raise UnreadableError(f"{path}: cannot be read: {error}") from None


def _opened(path: Path, note: Note) -> Iterator[Frame]:
    if path.suffix.lower() in CAPTURES:
        return capture.frames(path, lambda text: note(f"{path}: {text}"))
    if can_files.is_foreign(path):
        found = can_files.frames(path, lambda text: note(f"{path}: {text}"))
        return ((at, bus, one.address, one.payload) for at, bus, one in found)
    return _candump(path, note)


def _of_run(folder: Path) -> Path:
    """Return the recording of the bus in a folder of a run."""
    for name in (RUN_LOG, *(f"{RUN_LOG}{suffix}" for suffix in COMPRESSED)):
        if (folder / name).is_file() and (folder / name).stat().st_size:
            return folder / name
    raise UnreadableError(f"{folder}: holds no {RUN_LOG} with frames; name the recording itself")


def _first(path: Path) -> bytes | None:
    """Return the first byte of a file; None where there is none."""
    with path.open("rb") as file:
        return file.read(1) or None


def _candump(path: Path, note: Note) -> Iterator[Frame]:
    """Yield the frames of a candump log."""
    opened = COMPRESSED.get(path.suffix, open)
    with opened(path, "rt", encoding="ascii", errors="replace") as lines:
        try:
            yield from _parsed(path, lines, note)
        except EOFError:
            note(f"{path}: its end is cut off")


def _parsed(path: Path, lines: Iterable[str], note: Note) -> Iterator[Frame]:
    identifiers: dict[str, int] = {}
    at, bus, address, payload = 0, "", 0, b""
    for number, line in enumerate(lines, start=1):
        try:
            # The usual line, without a regular expression: the other forms take the path below.
            stamp, bus, frame = line.split()
            identifier, mark, data = frame.partition("#")
            if identifier not in identifiers:
                identifiers[identifier] = _address(identifier)
            address = identifiers[identifier]
            at = int(stamp[1:-_MICROSECONDS]) * SECOND + int(stamp[1 - _MICROSECONDS : -1]) * MICROSECOND
            payload = bytes.fromhex(data)
            usual = stamp[-_MICROSECONDS] == "." and stamp[0] == "(" and len(data) <= _MOST and bool(mark)
        except (ValueError, IndexError):
            usual = False
        if usual:
            yield at - EPOCH, bus, address, payload
        elif (found := _unusual(path, number, line, note)) is not None:
            yield found


def _address(identifier: str) -> int:
    address = int(identifier, 16)
    # The number of digits decides between 11 and 29 bits; the value cannot.
    return address if len(identifier) == _SHORT or address & ERROR else address | EXTENDED


def _unusual(path: Path, number: int, line: str, note: Note) -> Frame | None:
    """Return the frame of a line in another of candump's forms; None for a line without one."""
    if not line.strip("\0 \t\r\n"):
        return None
    if "##" in line:
        note(f"{path}, line {number}: a CAN FD frame is left out")
        return None
    try:
        at, bus, packet = parse_candump(line.rstrip("\r\n"))
    except RecordingError:
        found = _on_screen(line)
        if found is None and not _cut_off(line, number):
            raise UnreadableError(_no_line(path, number, line)) from None
        if found is None:
            note(f"{path}: its end is cut off; line {number} is left out")
        return found
    return at, bus, packet.address, packet.payload


def _on_screen(line: str) -> Frame | None:
    """Return the frame of a line that `candump -ta` shows on a screen; None for another line."""
    fields = line.split()
    if len(fields) < _SHOWN or not fields[0].startswith("(") or not fields[3].startswith("["):
        return None
    try:
        seconds, _, fraction = fields[0].strip("()").partition(".")
        at = int(seconds) * SECOND + int(fraction.ljust(9, "0")) - EPOCH
        address, length = _address(fields[2]), int(fields[3].strip("[]"))
        if fields[4:] == ["remote", "request"]:
            return at, fields[1], address | REMOTE, bytes(length)
        return at, fields[1], address, bytes.fromhex("".join(fields[4 : 4 + length]))
    except ValueError:
        return None


def _cut_off(line: str, number: int) -> bool:
    """Return whether a line may be the last of a recording whose end was lost."""
    return line.startswith("(") and not line.endswith("\n") and number > 1


def _no_line(path: Path, number: int, line: str) -> str:
    if is_chunk(line):
        return f"{path}, line {number}: a line of bytes of a serial line, among frames"
    if "[" in line and "]" in line and line.isascii():
        return f"{path}, line {number}: what candump shows has no times; record it with `candump -L`"
    return (
        f"{path}, line {number}: no line of a candump log, as '(12.345678) can0 123#DEADBEEF'; other formats "
        f"are read by their suffix: {', '.join((*can_files.SUFFIXES, *CAPTURES))}"
    )
