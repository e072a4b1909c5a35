"""The black box of a run on real links: its packets and reported texts, in files of the field.

A thread writes (`firmware_bridge.runtime.disk_thread`). Each run has a folder of its own, named by when it
began:

* `can.log`, as `candump -l` writes it, without the marks R and T, which Wireshark does not read;
* `serial.log`: instant, link, R or T, and the bytes, for a line to drives or to a board;
* `capture.log`: the same of the datagrams of cameras, with the place that they came from or went to;
* `operator.tlog`, MAVLink's telemetry log, and `stations.log`: the source of each station, which it lacks;
* `run.json`, the robot as it is driven, `places.json`, its axes' last known positions;
* `events.log`: the texts at the terminal and to the operator, with control changes, arming and stops.
"""

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import BinaryIO, Final, Self, TypeAlias

from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.recording import (
    Direction,
    candump_line,
    chunk_line,
    mavlink_messages,
    mavlink_origin,
    tlog_records,
)
from firmware_bridge.runtime.disk_thread import DiskThread
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds

CAN_LOG: Final = "can.log"
SERIAL_LOG: Final = "serial.log"
CAPTURE_LOG: Final = "capture.log"
OPERATOR_LOG: Final = "operator.tlog"
EVENTS_LOG: Final = "events.log"
STATIONS_LOG: Final = "stations.log"
"""A line when a station is received first, or from elsewhere: instant, place, system and component."""

Written: TypeAlias = tuple[str, bytes]
"""A file's name, and what is added to it."""
Noted: TypeAlias = tuple[Nanoseconds, Direction, Packet] | tuple[Nanoseconds, str]
"""A packet, or a text of the terminal with its Unix time."""
Texts: TypeAlias = Callable[[bytes], Iterable[str]]
"""Extraction of a datagram's texts for people."""


def no_texts(_datagram: bytes) -> Iterable[str]:
    """Read none."""
    return ()


class BlackBoxError(Exception):
    """A folder that cannot be made: which, why, and what to do."""


def new_file(path: Path) -> BinaryIO:
    """Make the file of a recording before its run, so that what cannot be made is refused at the start."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return path.open("xb")
    except OSError as error:
        raise BlackBoxError(
            f"cannot record in {path}: {error.strerror}; name a new file that can be written"
        ) from error


class BlackBox:
    """One run's recording. `note` and `report` never wait and never fail."""

    def __init__(
        self,
        parent: Path,
        files: Mapping[str, str],
        say: Callable[[str], None],
        texts: Texts = no_texts,
        called: Mapping[str, str] = MappingProxyType({}),
        *,
        known: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        """Make the run's folder in `parent`; `files` gives each link's file. BlackBoxError.

        `called` has names that links have in a log of lines, where these are others; `known` is, by the names
        of files, the program's knowledge before it received anything.
        """
        began = datetime.now(tz=UTC).strftime("%Y-%m-%dT%H-%M-%SZ")
        self.folder = parent / began
        try:
            self.folder = _new(self.folder)
            names = {*files.values(), EVENTS_LOG}
            names |= {STATIONS_LOG} if OPERATOR_LOG in names else set()
            # Opened before the run, so that a folder that cannot be written is refused at the start.
            self._open = {name: (self.folder / name).open("ab") for name in names}
            for name, text in known.items():
                (self.folder / name).write_text(text, encoding="utf-8")
        except OSError as error:
            raise BlackBoxError(
                f"cannot record in {parent}: {error.strerror}; name a folder that can be written"
            ) from error
        self._files = dict(files)
        self._say = say
        self._texts = texts
        self._called = called
        self._last_text = ""
        self._spoke_from: dict[tuple[int, int], int] = {}
        self._epoch: Nanoseconds | None = None
        self._disk = DiskThread(self.folder, say, self._empty, self._close)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Bring what waits to the disk, and say so where that failed."""
        self._disk.end()

    def note(self, now: Nanoseconds, direction: Direction, packet: Packet) -> None:
        """Take down a packet."""
        if self._epoch is None:
            # Whole microseconds, so that the telemetry log, which has no less, keeps the run's own instants.
            self._epoch = (time.time_ns() - now) // MICROSECOND * MICROSECOND
        self._disk.put((now, direction, packet))

    def report(self, text: str) -> None:
        """Say it at the terminal, and take it down."""
        self._say(text)
        self._disk.put((time.time_ns(), text))

    def _close(self) -> None:
        for file in self._open.values():
            _closed(file)

    def _empty(self, waiting: deque[Noted]) -> None:
        parts: dict[str, list[bytes]] = {name: [] for name in self._open}
        while waiting:
            for name, raw in self._lines(waiting.popleft()):
                parts[name].append(raw)
        for name, raws in parts.items():
            if raws:
                # One write for each file in 0.2 s, not one for each frame.
                self._open[name].write(b"".join(raws))
                self._open[name].flush()

    def _lines(self, noted: Noted) -> list[Written]:
        if len(noted) == 2:  # noqa: PLR2004 - a text, not a packet
            return [_event(noted[0], noted[1])]
        now, direction, packet = noted
        epoch, name = self._epoch or 0, self._files.get(packet.link)
        if name == OPERATOR_LOG:
            records = (name, tlog_records(now, packet.payload, epoch))
            sent = packet.payload if direction is Direction.SENT else b""
            received = self._new_places(now, packet, epoch) if direction is Direction.RECEIVED else ()
            return [records, *received, *(_event(epoch + now, text) for text in self._new_texts(sent))]
        if name == CAN_LOG:
            return [(name, f"{candump_line(now, packet, packet.link, epoch)}\n".encode())]
        if name is not None and name.endswith((SERIAL_LOG, CAPTURE_LOG)) and packet.payload:
            line = chunk_line(now, self._called.get(packet.link, packet.link), direction, packet, epoch)
            return [(name, f"{line}\n".encode())]
        return []

    def _new_places(self, now: Nanoseconds, packet: Packet, epoch: Nanoseconds) -> Iterator[Written]:
        """Yield from where a station speaks, where that is new."""
        for message in mavlink_messages(packet.payload):
            station = mavlink_origin(message)[:2]
            if self._spoke_from.get(station) != packet.address:
                self._spoke_from[station] = packet.address
                line = chunk_line(
                    now, OPERATOR, Direction.RECEIVED, Packet(OPERATOR, packet.address, bytes(station)), epoch
                )
                yield STATIONS_LOG, f"{line}\n".encode()

    def _new_texts(self, datagram: bytes) -> Iterator[str]:
        """Yield what the operator is informed of; what is sent to several stations, once."""
        for text in self._texts(datagram):
            # A text goes to each station in a datagram of its own, one after the other.
            if text != self._last_text:
                self._last_text = text
                yield f"to the operator: {text}"


def _event(at: Nanoseconds, text: str) -> Written:
    return EVENTS_LOG, f"{_instant(at)} {text}\n".encode()


def _instant(at: Nanoseconds) -> str:
    seconds, rest = divmod(at, SECOND)
    return f"({seconds:010d}.{rest // MICROSECOND:06d})"


def _new(folder: Path) -> Path:
    """Make a folder that is not there yet, numbered where two runs begin in one second; OSError."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    number, name = 1, folder.name
    while True:
        try:
            folder.mkdir()
        except FileExistsError:
            number += 1
            folder = folder.with_name(f"{name}-{number}")
        else:
            return folder


def _closed(file: BinaryIO) -> None:
    """Close a file; lines that a full disk does not take are lost, and were reported."""
    with suppress(OSError):
        file.close()
