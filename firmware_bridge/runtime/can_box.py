"""The CAN frames of a run on real links as one file of another tool; `runtime.black_box` is the folder.

Importing this module takes python-can 0.1 s.
"""

from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Final, Self, TypeAlias

from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction
from firmware_bridge.runtime.black_box import CAN_LOG, new_file
from firmware_bridge.runtime.can_file_writer import CanFileWriter
from firmware_bridge.runtime.disk_thread import DiskThread
from firmware_bridge.units import Nanoseconds

Noted: TypeAlias = tuple[Nanoseconds, Direction, Packet]


class CanBox:
    """One run's frames. `note` and `report` never wait and never fail."""

    def __init__(self, path: Path, files: Mapping[str, str], say: Callable[[str], None]) -> None:
        """Make the file; BlackBoxError where that is not possible, or where it is there already.

        `files` gives the file that each link has in the folder of a black box, and so the link's kind.
        """
        self._file = new_file(path)
        self.path: Final = path
        self._say: Final = say
        self._buses: Final = tuple(link for link, name in files.items() if name == CAN_LOG)
        self._writer: Final = CanFileWriter(self._file, path, self._buses)
        self._disk: Final[DiskThread[Noted]] = DiskThread(path, say, self._write, self._close)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Bring what waits to the disk, and say so where that failed, or where something is left out."""
        self._disk.end()
        if remark := self._writer.remark(self.path):
            self._say(remark)

    def note(self, now: Nanoseconds, direction: Direction, packet: Packet) -> None:
        """Take down a packet of a bus; others have no place in the file."""
        if packet.link in self._buses:
            self._disk.put((now, direction, packet))

    def report(self, text: str) -> None:
        """Say it at the terminal; the file has no place for it."""
        self._say(text)

    def _write(self, waiting: deque[Noted]) -> None:
        if not waiting:
            return
        while waiting:
            at, direction, packet = waiting.popleft()
            self._writer.frame(at, packet.link, packet, sent=direction is Direction.SENT)
        self._writer.flush()

    def _close(self) -> None:
        with self._file:
            self._writer.finish()
