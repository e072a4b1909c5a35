"""Datagrams over UDP, for MAVLink: `udpin:HOST:PORT` waits for operators, `udpout:HOST:PORT` calls one."""

import errno
import re
import socket
from typing import Any, Final

from firmware_bridge.shell.ports.port import BURST, PortError
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

PEER_MEMORY: Final = 10 * SECOND
"""A peer that was silent for longer is answered no more."""
MOST_PEERS: Final = 16
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
        self._heard: dict[Any, Nanoseconds] = {}
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
        """Return the datagrams that have arrived, and remember who sent them."""
        datagrams: list[tuple[int, bytes]] = []
        for _ in range(BURST):
            try:
                datagram, peer = self._socket.recvfrom(_LARGEST)
            except ConnectionRefusedError:
                continue  # the answer to something that was sent before: nobody is there yet
            except OSError:
                break
            datagrams.append((0, datagram))
            if not self._calls:
                self._remember(peer, now)
        return datagrams

    def write(self, _address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send a datagram to the one that is called, or to all that were heard within `PEER_MEMORY`."""
        if self._calls:
            try:
                self._socket.send(payload)
            except OSError:
                self.unsent += 1
            return
        for peer, heard_at in list(self._heard.items()):
            if now - heard_at > PEER_MEMORY:
                del self._heard[peer]
                continue
            try:
                self._socket.sendto(payload, peer)
            except OSError:
                self.unsent += 1

    def flush(self, now: Nanoseconds) -> None:
        """Do nothing: a datagram goes out at once or never."""

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def _remember(self, peer: object, now: Nanoseconds) -> None:
        if peer not in self._heard and len(self._heard) >= MOST_PEERS:
            del self._heard[min(self._heard, key=self._heard.__getitem__)]
        self._heard[peer] = now


def _parsed(link: str) -> tuple[str, int, Any]:
    match = _FORM.fullmatch(link)
    if match is None or int(match["port"]) > 0xFFFF:  # noqa: PLR2004 - the largest port
        raise PortError(
            f"cannot open {link!r}: say udpin:HOST:PORT or udpout:HOST:PORT, as udpin:127.0.0.1:14550"
        )
    host = match["host"].strip("[]") or "0.0.0.0"  # noqa: S104 - an empty host asks for all addresses
    try:
        found = socket.getaddrinfo(host, int(match["port"]), type=socket.SOCK_DGRAM)
    except OSError as error:
        raise PortError(f"cannot open {link}: no such host '{host}' ({error.strerror})") from error
    family, _, _, _, address = found[0]
    return match["way"], family, address
