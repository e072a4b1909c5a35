"""The interface of a port, and the two ways in which a port fails: at the start, or under way."""

from typing import Final, Protocol

from firmware_bridge.units import Nanoseconds

BURST: Final = 64
"""So many packets at most in one go, so that a flood of them does not hold up the clock."""


class PortError(Exception):
    """A port that cannot be opened: which, why, and what to do."""


class LostPort(Exception):  # noqa: N818 - the name is the event
    """A port that worked and is gone: an interface taken down, an adapter unplugged, a bus that is off."""

    def __init__(self, port: "Port", problem: str) -> None:
        super().__init__(f"lost {port.name}: {problem}")
        self.port = port


class Port(Protocol):
    """One way out of the process; it never blocks for long."""

    name: str
    """For people: interface and channel, or address."""
    retry_at: Nanoseconds
    """Time of the next call of `flush`, `NEVER` while nothing waits to be sent."""

    def fileno(self) -> int:
        """Return a file that can be read when packets have arrived."""

    def read(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return address and payload of what has arrived, `BURST` at most; LostPort."""

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send a packet, or keep it for `flush`; LostPort."""

    def flush(self, now: Nanoseconds) -> None:
        """Try again to send what could not be sent; LostPort when that takes too long."""

    def close(self) -> None:
        """Give the port back; never fails, and may be called again."""
