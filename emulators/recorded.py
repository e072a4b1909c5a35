"""Traffic of a rig's wires, in field formats: candump lines, lines of bytes and datagrams, a tlog."""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Final, TypeAlias

from emulators.rig import BRIDGE, Rig
from emulators.wires import DatagramWire, FaultyCanWire, SerialWire
from emulators.wires.ends import Observer
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction, candump_line, chunk_line, tlog_records
from firmware_bridge.runtime.can_files import OF_FRAMES
from firmware_bridge.units import Nanoseconds

if TYPE_CHECKING:
    from firmware_bridge.runtime.can_file_writer import CanFileWriter

FRAMES, CHUNKS, SIGHTS, WORDS = "can.log", "serial.log", "capture.log", "operator.tlog"
"""The files' names in a run's folder: of buses, serial lines, cameras and the operator."""
FILES: Final = (FRAMES, CHUNKS, SIGHTS, WORDS)

Files: TypeAlias = Mapping[str, IO[bytes]]
"""Output files, by their names."""
RecordedWire: TypeAlias = tuple[FaultyCanWire | SerialWire | DatagramWire, Observer]


def recorded_wires(rig: Rig, files: Files) -> Iterator[RecordedWire]:
    """Give each wire and what writes down its packets: buses, serial lines, cameras, the operator's link."""

    def note_datagram(now: Nanoseconds, _sender: str, packet: Packet) -> None:
        files[WORDS].write(tlog_records(now, packet.payload))

    for link, wire in rig.can_wires.items():
        yield wire, _frames_noted(files[FRAMES], link)
    for link, line in rig.lines.items():
        yield line.wire, _bytes_noted(files[CHUNKS], link)
    for link, seen in rig.datagram_wires.items():
        yield seen, _bytes_noted(files[SIGHTS], link)
    yield rig.operator_wire, note_datagram


@contextmanager
def recorded(rig: Rig, folder: Path) -> Iterator[None]:
    """Write what the wires carry while this is open into a folder; of cameras where some see the robot."""
    names = [name for name in FILES if name != SIGHTS or rig.datagram_wires]
    with ExitStack() as opened:
        files = {name: opened.enter_context((folder / name).open("wb")) for name in names}
        for wire, observer in recorded_wires(rig, files):
            wire.observe(observer)
        yield


@contextmanager
def frames_recorded(rig: Rig, path: Path | None) -> Iterator[None]:
    """Write the frames of all buses while this is open into a file of another tool, where it is named so.

    OSError where it cannot be written.
    """
    if path is None or path.suffix.lower() not in OF_FRAMES:
        yield
        return
    # 0.1 s for python-can, which no other run needs.
    from firmware_bridge.runtime.can_file_writer import CanFileWriter  # noqa: PLC0415 - see above

    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        writer = CanFileWriter(file, path, tuple(rig.can_wires))
        for link, wire in rig.can_wires.items():
            wire.observe(_frames_written(writer, link))
        try:
            yield
        finally:
            # A run that fails is the one whose frames are wanted.
            writer.finish()


def _frames_written(writer: "CanFileWriter", link: str) -> Observer:
    def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
        writer.frame(now, link, packet, sent=sender == BRIDGE)

    return note


def _frames_noted(frames: IO[bytes], channel: str) -> Observer:
    def note(now: Nanoseconds, _sender: str, packet: Packet) -> None:
        frames.write(f"{candump_line(now, packet, channel)}\n".encode())

    return note


def _bytes_noted(chunks: IO[bytes], link: str) -> Observer:
    def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
        if packet.payload:
            direction = Direction.SENT if sender == BRIDGE else Direction.RECEIVED
            chunks.write(f"{chunk_line(now, link, direction, packet)}\n".encode())

    return note
