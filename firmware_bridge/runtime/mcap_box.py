"""The black box of a run on real links as one file in MCAP; `runtime.black_box` is the folder.

Times are those of the run: nanoseconds from 0 by a monotonic clock. Importing this module needs the extra
`mcap`: see `firmware_bridge.extras.from_extras`.
"""

import time
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import Final, Self, TypeAlias

from firmware_bridge.mavlink.operator_texts import OperatorTexts
from firmware_bridge.mcap_file.bridge_watch import BridgeWatch, Look
from firmware_bridge.mcap_file.writer import RecordingWriter
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction
from firmware_bridge.runtime.black_box import CAN_LOG, SERIAL_LOG, new_file
from firmware_bridge.runtime.disk_thread import DiskThread
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.units import Nanoseconds

PROGRAM: Final = "firmware-bridge"
"""Source of the texts at the terminal; that of the others is the operator's link."""
Noted: TypeAlias = tuple[Nanoseconds, Direction, Packet] | tuple[Nanoseconds, str] | Look


class McapBox:
    """One run's recording. `note` and `report` never wait and never fail."""

    def __init__(
        self,
        path: Path,
        files: Mapping[str, str],
        say: Callable[[str], None],
        called: Mapping[str, str] = MappingProxyType({}),
        *,
        known: Mapping[str, str] = MappingProxyType({}),
        watch: BridgeWatch | None = None,
    ) -> None:
        """Make the file; BlackBoxError where that is not possible, or where it is there already.

        `files` gives the file that each link has in the folder of a black box, and so the link's kind;
        `called` and `known` are as there. `watch` shows the bridge where one runs here.
        """
        self._file = new_file(path)
        self.path: Final = path
        self._say: Final = say
        self._files: Final = dict(files)
        self._called: Final = dict(called)
        self._watch: Final = watch
        self._texts: Final = OperatorTexts()
        self._zero: Nanoseconds | None = None
        """Instant of the monotonic clock at which the run began; None before the first packet."""
        self._newest: Nanoseconds = 0
        self._writer: Final = RecordingWriter(self._file, {})
        for name, text in known.items():
            self._writer.attach(name, "application/json", text.encode())
        self._disk: Final[DiskThread[Noted]] = DiskThread(path, say, self._write, self._close)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Bring what waits to the disk, and say so where that failed."""
        self._disk.end()

    def note(self, now: Nanoseconds, direction: Direction, packet: Packet) -> None:
        """Take down a packet, and the bridge's state where it is new."""
        if self._zero is None:
            self._zero = time.monotonic_ns() - now
        self._newest = now
        self._disk.put((now, direction, packet))
        if self._watch is not None:
            look = self._watch.look(now)
            if look is not None:
                self._disk.put(look)

    def report(self, text: str) -> None:
        """Say it at the terminal, and take it down."""
        self._say(text)
        # A device's clock leaves out the time in which the process did not run: never before a packet.
        now = 0 if self._zero is None else time.monotonic_ns() - self._zero
        self._disk.put((max(now, self._newest), text))

    def _write(self, waiting: deque[Noted]) -> None:
        if not waiting:
            return
        while waiting:
            row = waiting.popleft()
            if isinstance(row, Look):
                if self._watch is not None:
                    self._watch.write(row, self._writer)
            elif len(row) == 2:  # noqa: PLR2004 - a text, not a packet
                self._writer.text(row[0], Severity.INFO, PROGRAM, row[1])
            else:
                self._write_packet(*row)
        self._writer.flush()

    def _write_packet(self, at: Nanoseconds, direction: Direction, packet: Packet) -> None:
        name, sent = self._files.get(packet.link), direction is Direction.SENT
        if name == CAN_LOG:
            self._writer.frame(at, packet.link, packet, sent=sent)
        elif name is None or not packet.payload:
            return
        elif name.endswith(SERIAL_LOG):
            link = self._called.get(packet.link, packet.link)
            self._writer.chunk(at, link, packet.payload, sent=sent)
        else:
            self._writer.datagram(at, packet.link, packet, sent=sent)
            for text in self._texts.read(packet.payload) if sent and packet.link == OPERATOR else ():
                self._writer.text(at, text.severity, OPERATOR, text.text)

    def _close(self) -> None:
        with self._file:
            self._writer.finish()
