"""The live page's port: HTTP and WebSocket on loopback, without a thread of its own.

Importing this module needs the extra `live` (websockets): see `firmware_bridge.extras.from_extras`.
"""

import secrets
import selectors
import socket
from contextlib import suppress
from http import HTTPStatus
from typing import Any, Final

from websockets.datastructures import Headers
from websockets.frames import CloseCode, Frame, Opcode
from websockets.http11 import Request, Response
from websockets.protocol import State
from websockets.server import ServerProtocol

from firmware_bridge.live.messages import ALL_PAGES, CLOSED, OPENED
from firmware_bridge.live.site import Answer, LiveSite, PageRequest
from firmware_bridge.runtime.ports.port import PortError
from firmware_bridge.units import NEVER, Nanoseconds

LOOPBACK: Final = "127.0.0.1"
MOST_CLIENTS: Final = 16
"""Connections at a time; a browser holds up to six for one page."""
LARGEST: Final = 65_536
"""Bytes of a message of the page; a longer one ends its connection."""
CHUNK: Final = 65_536
MOST_UNSENT: Final = 1 << 20
"""Bytes that wait for a page; one that reads slower is dropped, so that memory stays as it is."""


class _Client:
    """One connection."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection: Final = connection
        self.protocol: Final = ServerProtocol(max_size=LARGEST)
        self.unsent = b""
        self.ends = False
        """True once what is unsent is the last."""

    @property
    def opened(self) -> bool:
        return self.protocol.state is State.OPEN


class LiveSocket:
    """A `firmware_bridge.runtime.ports.port.Port` whose packets are JSON, and whose addresses are pages.

    It is never lost: without it the program runs on.
    """

    def __init__(self, port: int = 0, token: str = "") -> None:
        """Listen on a port of loopback, 0 for any; PortError."""
        self.retry_at: Nanoseconds = NEVER
        try:
            self._listener: Final = socket.create_server((LOOPBACK, port))
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise PortError(f"cannot open the live page at {LOOPBACK}:{port}: {reason}") from error
        number = self._listener.getsockname()[1]
        self.token: Final = token or secrets.token_urlsafe(16)
        self.name = f"http://{LOOPBACK}:{number}/{self.token}/"
        """The address for a browser."""
        self._site: Final = LiveSite(self.token, number)
        self._ready: Final = selectors.DefaultSelector()
        self._listener.settimeout(0)
        self._ready.register(self._listener, selectors.EVENT_READ)
        self._clients: dict[int, _Client] = {}
        self._count = ALL_PAGES

    def fileno(self) -> int:
        """Return the file of all its sockets."""
        return int(self._ready.fileno())

    def read(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return the messages that have arrived, `OPENED` and `CLOSED`, each with the number of its page."""
        del now
        found: list[tuple[int, bytes]] = []
        for key, events in self._ready.select(0):
            if key.data is None:
                self._accept()
                continue
            # It may have made room for another one just now.
            if events & selectors.EVENT_WRITE and key.data in self._clients:
                found += self._pushed(key.data)
            if events & selectors.EVENT_READ and key.data in self._clients:
                found += self._received(key.data)
        return found

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send a message to a page, or to `ALL_PAGES`; a page that does not read is dropped."""
        del now
        for number in tuple(self._clients) if address == ALL_PAGES else (address,):
            client = self._clients.get(number)
            if client is not None and client.opened:
                client.protocol.send_text(payload)
                self._send(number)

    def flush(self, now: Nanoseconds) -> None:
        """Do nothing: what is unsent leaves when its socket takes it."""

    def close(self) -> None:
        """Close all connections."""
        for number, client in tuple(self._clients.items()):
            if client.opened:
                client.protocol.send_close(CloseCode.GOING_AWAY)
                self._send(number)
            self._drop(number)
        self._ready.close()
        self._listener.close()

    def _accept(self) -> None:
        try:
            connection, _ = self._listener.accept()
        except OSError:
            return  # it has left again
        if len(self._clients) >= MOST_CLIENTS and not self._made_room():
            connection.close()
            return
        connection.settimeout(0)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._count += 1
        self._clients[self._count] = _Client(connection)
        self._ready.register(connection, selectors.EVENT_READ, self._count)

    def _made_room(self) -> bool:
        """Drop the oldest connection that is no page yet; False where all are."""
        for number, client in self._clients.items():
            if not client.opened:
                self._drop(number)
                return True
        return False

    def _received(self, number: int) -> list[tuple[int, bytes]]:
        """Take what has arrived for a connection; return its messages, and whether it has come or left."""
        client = self._clients[number]
        was_open = client.opened
        try:
            chunk = client.connection.recv(CHUNK)
        except BlockingIOError:
            return []
        except OSError:
            chunk = b""
        if chunk:
            client.protocol.receive_data(chunk)
        else:
            client.protocol.receive_eof()
            client.ends = True
        found = self._messages(number, client)
        self._send(number)
        client.ends = client.ends or client.protocol.close_expected()
        if client.ends and not client.unsent:
            self._drop(number)
        if (was_open or found) and (number not in self._clients or not client.opened):
            found.append((number, CLOSED))
        return found

    def _messages(self, number: int, client: _Client) -> list[tuple[int, bytes]]:
        found: list[tuple[int, bytes]] = []
        for event in client.protocol.events_received():
            if isinstance(event, Request):
                found += [(number, OPENED)] if self._answered(client, event) else []
            elif isinstance(event, Frame) and event.opcode is Opcode.TEXT and event.fin:
                found.append((number, bytes(event.data)))
        return found

    def _answered(self, client: _Client, request: Request) -> bool:
        """Answer an HTTP request; return whether a page has opened its WebSocket."""
        header = request.headers
        with suppress(Exception):  # a header that is there twice
            wanted = PageRequest(
                request.path.partition("?")[0], header.get("Host", ""), header.get("Origin", "")
            )
            answer = self._site.answer(wanted)
            if answer.opens:
                response = client.protocol.accept(request)
                client.protocol.send_response(response)
                return client.opened
            client.protocol.send_response(_response(answer))
            client.ends = True
            return False
        client.protocol.send_response(client.protocol.reject(HTTPStatus.BAD_REQUEST, "400 Bad Request\n"))
        client.ends = True
        return False

    def _send(self, number: int) -> None:
        """Send what a connection's protocol has for it, as far as its socket takes it."""
        client = self._clients[number]
        for part in client.protocol.data_to_send():
            client.unsent += part
            client.ends = client.ends or not part
        try:
            client.unsent = client.unsent[client.connection.send(client.unsent) :] if client.unsent else b""
        except BlockingIOError:
            pass
        except OSError:
            client.unsent, client.ends = b"", True
        wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.unsent else 0)
        self._ready.modify(client.connection, wanted, number)
        if len(client.unsent) > MOST_UNSENT:
            client.unsent, client.ends = b"", True
            # Its end is received as of one that has left.
            with suppress(OSError):
                client.connection.shutdown(socket.SHUT_RDWR)

    def _pushed(self, number: int) -> list[tuple[int, bytes]]:
        """Go on sending; a connection that has ended is dropped behind its last byte."""
        client = self._clients[number]
        was_open = client.opened
        self._send(number)
        if client.ends and not client.unsent:
            self._drop(number)
            return [(number, CLOSED)] if was_open else []
        return []

    def _drop(self, number: int) -> None:
        client = self._clients.pop(number, None)
        if client is not None:
            self._ready.unregister(client.connection)
            client.connection.close()


def _response(answer: Answer) -> Response:
    headers: dict[str, Any] = {
        "Content-Type": answer.content_type,
        "Content-Length": str(len(answer.body)),
        "Connection": "close",
        "Cache-Control": "no-store",
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Cross-Origin-Resource-Policy": "same-origin",
    }
    if answer.policy:
        headers["Content-Security-Policy"] = answer.policy
    return Response(answer.status.value, answer.status.phrase, Headers(headers), answer.body)
