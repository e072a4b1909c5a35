"""Datagrams over UDP, for MAVLink: `udpin:HOST:PORT` waits for operators, `udpout:HOST:PORT` calls one."""

import errno
import ipaddress
import re
import socket
from typing import Any, Final

from firmware_bridge.runtime.ports.port import BURST, PortError
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.internet import host_and_port, number_of, scope_of

_LARGEST: Final = 65_535
_FORM: Final = re.compile(r"(?P<way>udpin|udpout):(?P<host>\[[0-9A-Fa-f:.]+\]|[^:\[\]]*):(?P<port>\d{1,5})")

_PROBLEMS: Final = {
    errno.EADDRINUSE: "the port is in use; end the program that has it, or choose another port",
    errno.EADDRNOTAVAIL: "not an address of this machine; udpin takes one of its own, or 0.0.0.0 for all",
    errno.EACCES: "not allowed; ports below 1024 are for the administrator",
}


class UdpPort:
    """A UDP socket. PortError where it cannot be opened.

    It is never lost: an operator who cannot be reached is an operator who is silent.
    """

    def __init__(self, link: str) -> None:
        self.name = link
        self.retry_at: Nanoseconds = NEVER
        self.unsent = 0
        way, family, address = _parsed(link)
        self._calls = way == "udpout"
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.settimeout(0)
        try:
            if self._calls:
                self._socket.connect(address)
            else:
                self._socket.bind(address)
        except OSError as error:
            self._socket.close()
            problem = _PROBLEMS.get(error.errno or 0, str(error.strerror))
            raise PortError(f"cannot open {link}: {problem}") from error
        self._fileno = self._socket.fileno()

    @property
    def port(self) -> int:
        """The UDP port at this end."""
        return int(self._socket.getsockname()[1])

    def fileno(self) -> int:
        """Return the socket's file."""
        return self._fileno

    def read(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return the datagrams that have arrived, each with the number of its place; 0 for the one called."""
        del now
        datagrams: list[tuple[int, bytes]] = []
        for _ in range(BURST):
            try:
                datagram, peer = self._socket.recvfrom(_LARGEST)
            except ConnectionRefusedError:
                continue  # the answer to something that was sent before: no one is there yet
            except OSError:
                break
            # A datagram from port 0 cannot be answered, and its sender is not known.
            source = 0 if self._calls else _number(peer)
            if source is not None:
                datagrams.append((source, datagram))
        return datagrams

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send a datagram to the one that is called, or to the place with this number; 0 is no one there."""
        del now
        try:
            if self._calls:
                self._socket.send(payload)
            elif address:
                self._socket.sendto(payload, _socket_address(address))
        # Not an error of the robot: the operator link timeout notices a station that cannot be reached.
        except OSError:
            self.unsent += 1

    def flush(self, now: Nanoseconds) -> None:
        """Do nothing: a datagram goes out at once or never."""

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


def reaches_beyond(link: str) -> bool:
    """Return whether another machine can be at the other end of a link; PortError where it is none."""
    return not ipaddress.ip_address(_parsed(link)[2][0].partition("%")[0]).is_loopback


def _number(peer: Any) -> int | None:
    """Return the number of a place; None for one that cannot be answered: from port 0."""
    host, port, *more = peer
    try:
        return number_of(host, port, more[1] if more else 0)
    except ValueError:
        return None


def _socket_address(number: int) -> Any:
    scope = scope_of(number)
    return host_and_port(number) if scope is None else (*host_and_port(number), 0, scope)


def _parsed(link: str) -> tuple[str, int, Any]:
    match = _FORM.fullmatch(link)
    if match is None or int(match["port"]) > 0xFFFF:  # noqa: PLR2004 - the largest port
        raise PortError(
            f"cannot open {link!r}: give udpin:HOST:PORT or udpout:HOST:PORT, as udpin:127.0.0.1:14550"
        )
    host = match["host"].strip("[]") or "0.0.0.0"  # noqa: S104 - an empty host means all addresses
    try:
        found = socket.getaddrinfo(host, int(match["port"]), type=socket.SOCK_DGRAM)
    except OSError as error:
        raise PortError(f"cannot open {link}: no such host '{host}' ({error.strerror})") from error
    family, _, _, _, address = found[0]
    return match["way"], family, address
