"""The control port of a running program: lines over a Unix socket of its user, or over loopback TCP.

A Unix socket lies in the user's runtime folder with mode 0600. Over TCP a client's first line has to be
`{"token": "..."}`, because every user of the machine reaches a loopback address.
"""

import hmac
import json
import os
import secrets
import selectors
import socket
import stat
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from firmware_bridge.runtime.ports.port import PortError
from firmware_bridge.units import NEVER, Nanoseconds

FOLDER: Final = "firmware-bridge"
SUFFIX: Final = ".sock"
LOOPBACK: Final = "127.0.0.1"
MOST_CLIENTS: Final = 16
LONGEST: Final = 65_536
"""Bytes of a line without an end, after which a client is dropped."""
CHUNK: Final = 16_384


def runtime_folder() -> Path:
    """Return the folder of the user's sockets; it may not be there."""
    given = os.environ.get("XDG_RUNTIME_DIR")
    if given and Path(given).is_dir():
        return Path(given) / FOLDER
    return Path(tempfile.gettempdir()) / f"{FOLDER}-{os.getuid()}"


class _Client:
    """One connection, and what has come without the end of a line."""

    def __init__(self, connection: socket.socket, *, trusted: bool) -> None:
        self.connection: Final = connection
        self.trusted = trusted
        self.received = b""


class ControlSocket:
    """A `firmware_bridge.runtime.ports.port.Port` whose packets are lines, and whose addresses are clients.

    It is never lost: without it the program runs on.
    """

    def __init__(self, where: str, title: str) -> None:
        """Listen at `unix`, or `tcp` or `tcp:PORT` on loopback, or nowhere with `none`; PortError."""
        self.retry_at: Nanoseconds = NEVER
        self.token = ""
        self._path: Path | None = None
        self._listener: socket.socket | None = None
        self.name = where
        way, _, port = where.partition(":")
        try:
            if way == "unix" and not port:
                self._listener = self._unix(title)
                self.name = str(self._path)
            elif way == "tcp" and (not port or (port.isdecimal() and int(port) <= 0xFFFF)):  # noqa: PLR2004 - the largest port
                self.token = secrets.token_urlsafe(16)
                self._listener = socket.create_server((LOOPBACK, int(port or 0)))
                self.name = f"{LOOPBACK}:{self._listener.getsockname()[1]}"
            elif where != "none":
                raise PortError(f"--control {where}: give unix, tcp, tcp:PORT or none")
        except OSError as error:
            reason = error.strerror or str(error)
            raise PortError(f"cannot open the control port at {where}: {reason}") from error
        # Its own file can be read whenever one of all these can.
        self._ready: Final = selectors.DefaultSelector()
        if self._listener is not None:
            self._listener.settimeout(0)
            self._ready.register(self._listener, selectors.EVENT_READ)
        self._clients: dict[int, _Client] = {}
        self._count = 0

    def _unix(self, title: str) -> socket.socket:
        folder = runtime_folder()
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        state = folder.lstat()
        if not stat.S_ISDIR(state.st_mode) or state.st_uid != os.getuid():
            raise PortError(f"{folder} is not this user's own folder; remove it, or set XDG_RUNTIME_DIR")
        self._path = folder / f"{title}-{os.getpid()}{SUFFIX}"
        self._path.unlink(missing_ok=True)
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        # Before anyone can connect it has the mode.
        before = os.umask(0o177)
        try:
            listener.bind(str(self._path))
        finally:
            os.umask(before)
        listener.listen(MOST_CLIENTS)
        return listener

    def fileno(self) -> int:
        """Return the file of all its sockets."""
        return int(self._ready.fileno())

    def read(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return the lines that have arrived, each with the number of its client."""
        del now
        lines: list[tuple[int, bytes]] = []
        for key, _ in self._ready.select(0):
            if key.data is None:
                self._accept(key.fileobj)
            else:
                lines += self._lines_of(key.data)
        return lines

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send a line to a client; one that does not read is dropped."""
        del now
        client = self._clients.get(address)
        if client is not None:
            self._send(address, client, payload)

    def flush(self, now: Nanoseconds) -> None:
        """Do nothing: a client that takes no more is dropped."""

    def close(self) -> None:
        """Close all sockets, and remove the file."""
        for number in tuple(self._clients):
            self._drop(number)
        self._ready.close()
        if self._listener is not None:
            self._listener.close()
        if self._path is not None:
            with suppress(OSError):
                self._path.unlink(missing_ok=True)

    def _accept(self, listener: Any) -> None:
        try:
            connection, _ = listener.accept()
        except OSError:
            return  # it has left again
        if len(self._clients) >= MOST_CLIENTS:
            connection.close()
            return
        connection.settimeout(0)
        self._count += 1
        self._clients[self._count] = _Client(connection, trusted=not self.token)
        self._ready.register(connection, selectors.EVENT_READ, self._count)

    def _lines_of(self, number: int) -> list[tuple[int, bytes]]:
        client = self._clients[number]
        try:
            chunk = client.connection.recv(CHUNK)
        except BlockingIOError:
            return []
        except OSError:
            chunk = b""
        *lines, client.received = (client.received + chunk).split(b"\n")
        if not chunk or len(client.received) > LONGEST:
            self._drop(number)
        found = []
        for line in lines:
            if client.trusted:
                found.append((number, line))
            elif self._admits(line):
                client.trusted = True
            else:
                self._drop(number)
                break
        return found

    def _admits(self, line: bytes) -> bool:
        with suppress(ValueError, RecursionError):
            given = json.loads(line)
            token = given.get("token") if isinstance(given, dict) else None
            return isinstance(token, str) and hmac.compare_digest(token.encode(), self.token.encode())
        return False

    def _send(self, number: int, client: _Client, payload: bytes) -> None:
        try:
            sent = client.connection.send(payload)
        except OSError:
            sent = -1
        if sent != len(payload):
            self._drop(number)

    def _drop(self, number: int) -> None:
        client = self._clients.pop(number, None)
        if client is not None:
            self._ready.unregister(client.connection)
            client.connection.close()
