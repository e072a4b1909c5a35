"""Data through a file of the operating system: the common part of serial ports and pseudo-terminals.

Frames are not known here: received bytes come as one chunk, cut wherever the system cuts it.
"""

import os
from abc import ABC, abstractmethod
from typing import Final

from firmware_bridge.runtime.ports.port import LostPort
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

CHUNK: Final = 4096
RETRY: Final[Nanoseconds] = MILLISECOND


class ByteFile(ABC):
    """A file that is read and written without ever waiting; bytes that do not fit go out later."""

    name: str

    def __init__(self, fileno: int) -> None:
        self.retry_at: Nanoseconds = NEVER
        self._fileno = fileno
        self._waiting = bytearray()
        os.set_blocking(fileno, False)

    def fileno(self) -> int:
        """Return the file that can be read when bytes have arrived."""
        return self._fileno

    def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return the bytes that have arrived; LostPort where the other side is gone for good."""
        try:
            # Non-blocking: a read that waits would stop the cycle, and with it the drives' heartbeat.
            chunk = os.read(self._fileno, CHUNK)
        except BlockingIOError:
            return []
        except OSError as error:
            raise self._lost(str(error.strerror)) from error
        # An empty read is the end of the file: the adapter's device is gone.
        if not chunk:
            raise self._lost("it can be read and gives nothing; was the adapter unplugged?")
        return [(0, chunk)]

    def write(self, _address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send bytes, or keep them for `flush`; LostPort."""
        self._waiting += payload
        self.flush(now)

    def flush(self, now: Nanoseconds) -> None:
        """Send what waits, as far as there is room; LostPort."""
        self.retry_at = NEVER
        while self._waiting:
            try:
                sent = os.write(self._fileno, self._waiting)
            except BlockingIOError:
                self.retry_at = now + RETRY
                self._crowded(self._waiting)
                return
            except OSError as error:
                raise self._lost(str(error.strerror)) from error
            del self._waiting[:sent]

    @abstractmethod
    def close(self) -> None:
        """Give the file back."""

    @abstractmethod
    def _crowded(self, waiting: bytearray) -> None:
        """Judge bytes for which there is no room now."""

    def _lost(self, problem: str) -> LostPort:
        return LostPort(self, problem)
