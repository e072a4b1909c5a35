"""What a dissector needs of a kind of link: the format of its packets, and who reads them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Protocol

from firmware_bridge.packet import Packet

SHOWN: Final = 16
"""So many bytes of a packet without an identifier stand before its text."""


class Reader(Protocol):
    """A reader of one link's packets, one after the other."""

    def read(self, sender: str, packet: Packet) -> str:
        """Return the decoded text of a packet; every packet has one."""


def in_bytes(packet: Packet) -> str:
    """Return a packet's first bytes in hexadecimal, and how many there are."""
    payload = packet.payload
    return payload[:SHOWN].hex().upper() + (f"... ({len(payload)} bytes)" if len(payload) > SHOWN else "")


@dataclass(frozen=True, slots=True)
class Protocols:
    """Protocol of a kind of link: its reader, and the format of its packets."""

    reader: Callable[[], Reader]
    written: Callable[[Packet], str] = in_bytes
