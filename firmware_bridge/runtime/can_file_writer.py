"""CAN frames in other tools' files, by python-can's writers: `.asc` and `.blf` of Vector, `.trc` of PEAK.

Their dates count from `firmware_bridge.recording.EPOCH`, not from the day, so that one run gives one file.
`runtime.can_files` reads them. Importing this module takes python-can 0.1 s.
"""

from collections.abc import Callable, Mapping, Sequence
from io import TextIOWrapper
from pathlib import Path
from types import MappingProxyType
from typing import IO, Any, Final

import can

from firmware_bridge.packet import Packet
from firmware_bridge.recording import EPOCH
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, EXTENDED_MASK, REMOTE, identifier

PROGRAM: Final = "firmware-bridge"
DATE: Final = "Wed Jan 01 00:00:00.000 2020"
"""`EPOCH` as an .asc file has it, whatever the machine's time zone and language are."""
CONTAINER: Final = 8192
"""Bytes after which a .blf file is written on: so many at most are lost in a crash."""
HALF_NS: Final = 0.5


class _Vector(can.ASCWriter):
    """An .asc file whose instants are those of the run."""

    def __init__(self, file: TextIOWrapper, buses: Sequence[str]) -> None:
        super().__init__(file)
        names = "".join(f"// channel {number}: {bus}\n" for number, bus in enumerate(buses, start=1))
        file.write(f"{names}Begin Triggerblock {DATE}\n")
        # python-can begins at the first frame: every instant would be short of that of the first.
        self.header_written = True
        self.log_event("Start of measurement", 0.0)

    def _format_header_datetime(self, _dt: Any) -> str:
        return DATE


class _VectorBinary(can.BLFWriter):
    """A .blf file whose instants are those of the run; not compressed, as two versions of zlib differ."""

    def __init__(self, file: IO[bytes], _buses: Sequence[str]) -> None:
        super().__init__(file, compression_level=0, max_container_size=CONTAINER)  # type: ignore[arg-type]
        self.start_timestamp = 0.0

    def stop(self) -> None:
        """Write the header, and close the file."""
        # A float from 1970 on has no nanoseconds, so the date is put in front of the run's own at last.
        self.start_timestamp = EPOCH / SECOND
        self.stop_timestamp = EPOCH / SECOND + (self.stop_timestamp or 0.0)
        super().stop()


class _Peak(can.TRCWriter):
    """A .trc file, version 2.1, whose instants are those of the run; it has remote frames, too."""

    def __init__(self, file: TextIOWrapper, buses: Sequence[str]) -> None:
        super().__init__(file)
        self.filepath = PROGRAM
        self.write_header(EPOCH / SECOND)
        self.first_timestamp = 0.0
        names = "".join(f";   Bus {number}: {bus}\n" for number, bus in enumerate(buses, start=1))
        file.write(names)

    def on_message_received(self, msg: can.Message) -> None:
        """Write a frame."""
        if not msg.is_remote_frame:
            super().on_message_received(msg)
            return
        self.msgnr += 1
        number = f"{msg.arbitration_id:08X}" if msg.is_extended_id else f"{msg.arbitration_id:04X}"
        channel = msg.channel if isinstance(msg.channel, int) else 0
        where = f"RR {channel + 1:>2} {number:>8} {'Rx' if msg.is_rx else 'Tx'}"
        self.log_event(f"{self.msgnr:>7} {msg.timestamp * 1000:13.3f} {where} -  {msg.dlc:<4}", msg.timestamp)


def _as_text(kind: type[_Vector | _Peak]) -> "Callable[[IO[bytes], Sequence[str]], Any]":
    def make(file: IO[bytes], buses: Sequence[str]) -> Any:
        return kind(TextIOWrapper(file, encoding="utf-8", newline="\n"), buses)

    return make


_WRITERS: Final[Mapping[str, "Callable[[IO[bytes], Sequence[str]], Any]"]] = MappingProxyType(
    {".asc": _as_text(_Vector), ".blf": _VectorBinary, ".trc": _as_text(_Peak)}
)


class CanFileWriter:
    """One file. OSError where it cannot be written; without `finish` its end is missing, as after a crash."""

    def __init__(self, file: IO[bytes], path: Path, buses: Sequence[str]) -> None:
        """Begin the file in the format of its name; the buses get the channels 1, 2 and so on."""
        suffix = path.suffix.lower()
        self._writer: Final = _WRITERS[suffix](file, buses)
        self._channels: Final = {bus: number for number, bus in enumerate(buses)}
        self._has_errors: Final = suffix != ".trc"
        self.left_out = 0
        """Count of the error frames for which the format has no place."""

    def frame(self, at: Nanoseconds, bus: str, packet: Packet, *, sent: bool) -> None:
        """Add a frame, or an error report of the interface; its instant is cut to µs, as in can.log."""
        error, remote = bool(packet.address & ERROR), bool(packet.address & REMOTE)
        if error and not self._has_errors:
            self.left_out += 1
            return
        message = can.Message(
            # The writers multiply a float and cut it: without a half they would be short by one.
            timestamp=(at // MICROSECOND * MICROSECOND + HALF_NS) / SECOND,
            arbitration_id=packet.address & EXTENDED_MASK if error else identifier(packet.address),
            is_extended_id=bool(packet.address & EXTENDED),
            is_remote_frame=remote,
            is_error_frame=error,
            channel=self._channels[bus],
            dlc=len(packet.payload),
            data=None if remote else packet.payload,
            is_rx=not sent,
        )
        self._writer.on_message_received(message)

    def flush(self) -> None:
        """Bring to the file what the format lets out before its end."""
        self._writer.file.flush()

    def finish(self) -> None:
        """Write the end, and close the file."""
        self._writer.stop()

    def remark(self, path: Path) -> str:
        """Return what is not in the file, for the user; empty where it has everything."""
        if not self.left_out:
            return ""
        return f"{path}: {self.left_out} error frames are left out; .asc, .blf and .mcap have them"
