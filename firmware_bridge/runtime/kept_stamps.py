"""Time stamps of signatures, in a small file, so that no message is accepted again after a restart.

A stored stamp runs ahead by the messages that may be received until it is written next, at the pace of each
stream: a crash in between must not open it to a recording. Source: mavlink.io, "Message Signing".
"""

import json
from contextlib import suppress
from pathlib import Path
from typing import Final

from firmware_bridge.mavlink.trust import NO_STAMPS, UNIT, Stamps, Stream
from firmware_bridge.runtime.whole_file import WholeFile
from firmware_bridge.units import SECOND, Nanoseconds

EVERY: Final[Nanoseconds] = 2 * SECOND
_AHEAD: Final = 3 * EVERY // 2
_LARGEST: Final = (1 << 48) - 1
_PARTS: Final = 3


class DamagedStampsError(Exception):
    """The file is there, and cannot be read as what this wrote."""


class KeptStamps:
    """One robot's file."""

    def __init__(self, path: Path) -> None:
        self.path: Final = path
        self.file: Final = WholeFile(path)
        self._before: Stamps = NO_STAMPS
        self._due: Nanoseconds = 0

    def read(self) -> Stamps:
        """Return what was kept, nothing where there is no file; DamagedStampsError for any other file."""
        try:
            text = self.path.read_text(encoding="utf-8")
        except FileNotFoundError:
            return NO_STAMPS
        except (OSError, ValueError) as error:
            raise DamagedStampsError(f"{self.path}: cannot be read: {error}") from None
        with suppress(ValueError, TypeError, KeyError, AttributeError):
            table = json.loads(text)
            streams = {_stream(name): _stamp(stamp) for name, stamp in table["streams"].items()}
            own = _stamp(table["own"])
            return Stamps(own, _stamp(table.get("clock", own)), streams)
        raise DamagedStampsError(f"{self.path}: is damaged")

    def keep(self, stamps: Stamps, now: Nanoseconds) -> None:
        """Keep the stamps, ahead, where that is due or a new stream has begun."""
        # A new stream is written at once: after a crash an unknown stream would be accepted from its start.
        if now >= self._due or stamps.streams.keys() != self._before.streams.keys():
            self._due = now + EVERY
            before = self._before.streams
            streams = {one: _ahead(stamp, before.get(one)) for one, stamp in stamps.streams.items()}
            self.write(Stamps(stamps.own + _AHEAD // UNIT, stamps.clock, streams), now)
            self._before = stamps

    def write(self, stamps: Stamps, now: Nanoseconds) -> None:
        """Keep the stamps as they are."""
        streams = {"/".join(map(str, stream)): stamp for stream, stamp in stamps.streams.items()}
        self.file.replace(json.dumps({"own": stamps.own, "clock": stamps.clock, "streams": streams}), now)


def _ahead(stamp: int, before: int | None) -> int:
    # By the pace since the last write, for one and a half of its periods, as the next one may be late.
    return stamp if before is None else min(stamp + 3 * (stamp - before) // 2, _LARGEST)


def _stream(name: str) -> Stream:
    parts = [int(part) for part in name.split("/")]
    if len(parts) != _PARTS:
        raise ValueError(name)
    return parts[0], parts[1], parts[2]


def _stamp(value: object) -> int:
    if not isinstance(value, int) or not 0 <= value <= _LARGEST:
        raise ValueError(value)
    return value
