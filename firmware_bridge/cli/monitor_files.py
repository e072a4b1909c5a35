"""Recordings of a CAN bus as `monitor` reads them: candump, compressed, or of other tools."""

import gzip
import lzma
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import IO, Final, TypeAlias

from firmware_bridge.cli.console import WRONG_INPUT, refusal, say
from firmware_bridge.packet import Packet
from firmware_bridge.runtime import can_files
from firmware_bridge.units import Nanoseconds

_ON_SCREEN: Final = re.compile(r"\s*\S+\s+[0-9A-Fa-f]{3,8}\s+\[\d+\]")
_OPENERS: Final[Mapping[str, Callable[..., IO[str]]]] = {".gz": gzip.open, ".xz": lzma.open}

RECORD: Final = "record while frames are sent, as with candump -L"
"""What to do where a recording is empty."""

Frame: TypeAlias = tuple[Nanoseconds, str, Packet]
"""Instant, bus, frame."""


def numbered(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of a recording with their numbers and ends, blank ones left out.

    A file that cannot be read ends the program with a message.
    """
    opened = _OPENERS.get(path.suffix, open)
    try:
        with opened(path, "rt", encoding="ascii") as lines:
            for number, line in enumerate(lines, start=1):
                # A file system that lost its power may leave blocks of zeros at a file's end.
                if line.strip("\0 \t\r\n"):
                    yield number, line
                elif "\0" in line:
                    say(f"{path}: its end is cut off; line {number} is left out")
    except EOFError:
        say(f"{path}: its end is cut off")
    except (OSError, lzma.LZMAError, UnicodeDecodeError) as error:
        raise refusal(f"{path}: cannot be read: {error}", WRONG_INPUT) from None


def candump(path: Path, lines: Iterator[tuple[int, str]]) -> Iterator[Frame]:
    """Yield the frames of a candump log; a line that is none ends the program with a message."""
    from firmware_bridge.recording import RecordingError, parse_candump

    for number, line in lines:
        try:
            yield parse_candump(line.rstrip("\r\n"))
        except RecordingError:
            # A last line without its end was cut off with the run; anywhere else it is damage.
            if line.startswith("(") and not line.endswith("\n") and number > 1:
                say(f"{path}: its end is cut off; line {number} is left out")
                return
            if _ON_SCREEN.match(line):
                raise refusal(
                    f"{path}, line {number}: what candump shows on the screen has no times; record it with "
                    "candump -L"
                ) from None
            raise refusal(
                f"{path}, line {number}: no line of a candump log, as '(12.345678) can0 123#DEADBEEF'"
            ) from None


def foreign(path: Path) -> Iterator[Frame]:
    """Yield the frames of another tool's recording; one that cannot be read ends the program."""
    from firmware_bridge.recording import RecordingError

    try:
        yield from can_files.frames(path)
    except (RecordingError, OSError) as error:
        raise refusal(f"{path}: cannot be read: {error}", WRONG_INPUT) from None


def of_one_bus(
    path: str, channel: str | None, frames: Iterator[Frame]
) -> "Iterator[tuple[Nanoseconds, Packet]]":
    """Yield the frames of one bus of a recording; others in it end the program, where none was chosen.

    A recording without a frame is reported, and ends the program where a bus was chosen.
    """
    received: set[str] = set()
    for at, bus, packet in frames:
        received.add(bus)
        if channel is None and len(received) > 1:
            raise refusal(f"{path}: holds frames of {' and '.join(sorted(received))}; choose one with -c")
        if channel in {None, bus}:
            yield at, packet
    if channel is not None and channel not in received:
        others = ", ".join(sorted(received))
        has = (
            f"it holds frames of {others}; name one of these with -c" if others else f"it is empty; {RECORD}"
        )
        raise refusal(f"{path}: holds no frame of '{channel}': {has}")
    if not received:
        # Without a bus to look for, an empty recording is no error.
        say(f"firmware-bridge: {path}: holds no frame; {RECORD}", err=True)
