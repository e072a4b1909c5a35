"""The drive's USB port as a line: a converter chip at 1 MBd, from which the host reads once a millisecond.

Source: maxon's command library, which sets the chip's latency timer to 1 ms. The other way, from the host to
the drive, takes the time of the bytes only (assumed). USB frames, 62 bytes each, are not distinguished.
"""

from typing import Final

from emulators.wires.datagram import DatagramWire
from emulators.wires.serial import Inbox, SerialWire
from emulators.world import WorldNode
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, Nanoseconds

BAUD: Final = 1_000_000
LATENCY: Final[Nanoseconds] = MILLISECOND
BUFFER: Final = 4_096
"""Size of the buffer in bytes; larger than any packet of the drive in one latency time."""


class ChunkWire(DatagramWire):
    """USB between a host and a board with a second chip, which keeps the time of the bytes: whole chunks."""

    def __init__(self, delay: Nanoseconds, name: str) -> None:
        super().__init__(delay, name=name)
        self.bytes = 0
        """Carried so far, both ways."""

    def carry(self, sender: WorldNode, packet: Packet) -> None:
        """Send a chunk on its way."""
        self.bytes += len(packet.payload)
        super().carry(sender, packet)


def usb_line(host: str, name: str = "serial") -> SerialWire:
    """Return a line between a drive and the station `host`."""
    return SerialWire(BAUD, {host: Inbox(BUFFER, LATENCY)}, name)
