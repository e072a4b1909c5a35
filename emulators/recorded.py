"""What a rig's wires carry, as the field records it: candump lines, lines of serial bytes, a tlog."""

from collections.abc import Iterator
from typing import Protocol, TypeAlias

from emulators.rig import BRIDGE, Rig
from emulators.wires import DatagramWire, FaultyCanWire, SerialWire
from emulators.wires.ends import Observer
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction, candump_line, serial_line, tlog_records
from firmware_bridge.units import Nanoseconds

FRAMES, CHUNKS, WORDS = "can.log", "serial.log", "operator.tlog"
"""The files' names in a run's folder."""


class Lines(Protocol):
    """Where lines go."""

    def write(self, text: str, /) -> object:
        """Take a line with its end."""


class Records(Protocol):
    """Where a tlog's records go."""

    def write(self, data: bytes, /) -> object:
        """Take a record."""


Way: TypeAlias = tuple[FaultyCanWire | SerialWire | DatagramWire, Observer]


def ways(rig: Rig, frames: Lines, chunks: Lines, words: Records) -> Iterator[Way]:
    """Give each wire and what writes down its packets: the buses, the serial lines, the operator's link."""

    def note_datagram(now: Nanoseconds, _sender: str, packet: Packet) -> None:
        words.write(tlog_records(now, packet.payload))

    for link, wire in rig.can_wires.items():
        yield wire, _frames_noted(frames, link)
    for link, line in rig.lines.items():
        yield line.wire, _bytes_noted(chunks, link)
    yield rig.operator_wire, note_datagram


def record(rig: Rig, frames: Lines, chunks: Lines, words: Records) -> None:
    """Write down what the wires carry from now on."""
    for wire, observer in ways(rig, frames, chunks, words):
        wire.observe(observer)


def _frames_noted(frames: Lines, channel: str) -> Observer:
    def note(now: Nanoseconds, _sender: str, packet: Packet) -> None:
        frames.write(candump_line(now, packet, channel) + "\n")

    return note


def _bytes_noted(chunks: Lines, link: str) -> Observer:
    def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
        if packet.payload:
            direction = Direction.SENT if sender == BRIDGE else Direction.HEARD
            chunks.write(serial_line(now, link, direction, packet.payload) + "\n")

    return note
