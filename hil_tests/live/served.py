"""The live page's port in a thread of its own, and a browser's stand-in that speaks HTTP by hand."""

import select
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from firmware_bridge.live.socket import LiveSocket

HUNG_S: Final = 30.0


class Served:
    """A port that is read all the time; every message of a page comes back to it."""

    def __init__(self) -> None:
        self.port: Final = LiveSocket()
        self.number: Final = int(self.port.name.rpartition(":")[2].partition("/")[0])
        self._received: Final[list[tuple[int, bytes]]] = []
        self._rung, self._bell = socket.socketpair()
        self._thread: Final = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    @property
    def received(self) -> list[tuple[int, bytes]]:
        """What the port has returned of all that its clients have seen answered."""
        # A client sees an answer before the thread has stored what it answers; the next request is later.
        self.get(self.page)
        return self._received

    @property
    def page(self) -> str:
        """The path of the page."""
        return f"/{self.port.token}/"

    @property
    def websocket(self) -> str:
        """The address of the WebSocket."""
        return f"ws://127.0.0.1:{self.number}{self.page}ws"

    def end(self) -> None:
        """End the thread, and close the port."""
        self._bell.send(b"!")
        self._thread.join(HUNG_S)
        self.port.close()
        self._bell.close()
        self._rung.close()

    def get(self, path: str, host: str = "", origin: str = "") -> tuple[int, dict[str, str], bytes]:
        """Return status, headers and body of a GET."""
        lines = [f"GET {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{self.number}'}"]
        lines += [f"Origin: {origin}"] if origin else []
        received = self.raw("\r\n".join((*lines, "", "")).encode())
        head, _, body = received.partition(b"\r\n\r\n")
        first, *rest = head.decode().split("\r\n")
        pairs = (line.partition(": ")[::2] for line in rest)
        return int(first.split()[1]), {name.lower(): value for name, value in pairs}, body

    def raw(self, sent: bytes) -> bytes:
        """Send bytes and return all that comes until the port closes the connection."""
        with socket.create_connection(("127.0.0.1", self.number), timeout=HUNG_S) as client:
            client.sendall(sent)
            received = b""
            while chunk := client.recv(1 << 16):
                received += chunk
            return received

    def _serve(self) -> None:
        while True:
            ready, _, _ = select.select([self.port.fileno(), self._rung.fileno()], (), ())
            if self._rung.fileno() in ready:
                return
            for address, payload in self.port.read(0):
                self._received.append((address, payload))
                if payload.startswith(b"{"):
                    self.port.write(address, payload, 0)


@contextmanager
def served() -> Iterator[Served]:
    """Serve until the end of a test."""
    one = Served()
    try:
        yield one
    finally:
        one.end()
