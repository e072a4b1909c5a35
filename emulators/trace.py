"""The trace of a run: the traffic of its wires as text, and the running hash of that.

A line is ASCII: instant in ns, wire, sender, address as eight hexadecimal digits, payload as hexadecimal
digits, separated by single spaces and ended by a line feed. A packet is one line, for all its receivers.
"""

import hashlib
from functools import lru_cache

from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds


@lru_cache(maxsize=4096)
def _digits(address: int) -> str:
    """Return an address as the trace writes it; few are carried again and again."""
    return f"{address:08X}"


def trace_line(at: Nanoseconds, wire: str, sender: str, packet: Packet) -> bytes:
    """Return the line of one carried packet."""
    return f"{at} {wire} {sender} {_digits(packet.address)} {packet.payload.hex()}\n".encode()


def parse_trace_line(line: str) -> tuple[Nanoseconds, str, str, Packet]:
    """Return instant, wire, sender and packet of a line without its end; ValueError for what is none."""
    at, wire, sender, address, payload = line.split(" ")
    return int(at), wire, sender, Packet(wire, int(address, 16), bytes.fromhex(payload))


class Trace:
    """The running hash of what was carried; it can go back to an earlier instant."""

    __slots__ = ("_hash", "add")

    def __init__(self) -> None:
        self.restore_state(hashlib.sha256())

    @property
    def sha256(self) -> str:
        """The hash so far, in hexadecimal digits."""
        return self._hash.hexdigest()

    def save_state(self) -> "hashlib._Hash":
        """Keep what has been added so far."""
        return self._hash.copy()

    def restore_state(self, state: "hashlib._Hash") -> None:
        """Go on from what had been added then."""
        self._hash = state.copy()
        # Bound once: it is called for every packet of a run.
        self.add = self._hash.update
