"""A serial port that may vanish and come back: an adapter on USB that gets unplugged.

While it is gone bytes to send are dropped, and it is tried again four times a second. The node is informed by
an empty packet, `LINE_LOST` or `LINE_BACK`. `fileno` stays the same: the file behind it is exchanged.
"""

import contextlib
import os
import socket
from collections import deque
from typing import Final

from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.runtime.ports.port import LostPort, PortError
from firmware_bridge.runtime.ports.serial_line import SerialLine
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

TRY_EVERY: Final[Nanoseconds] = 250 * MILLISECOND


class ReturningLine:
    """A serial device; it must be there at the start. PortError with what to do where it is not."""

    def __init__(self, device: str, baud: int) -> None:
        self.name = f"serial port {device}"
        self.retry_at: Nanoseconds = NEVER
        self._device = device
        self._baud = baud
        self._line: SerialLine | None = SerialLine(device, baud)
        self._news: deque[int] = deque()
        # Its one end stands behind `fileno` while there is no device: the other one rings.
        self._quiet, self._bell = socket.socketpair()
        self._fileno = os.dup(self._line.fileno())

    def fileno(self) -> int:
        """Return the file that can be read when bytes, or news of the line, have arrived."""
        return self._fileno

    def read(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return what has arrived, or what became of the line."""
        if self._news:
            return self._events(now)
        if self._line is None:
            return []
        try:
            return self._line.read(now)
        except LostPort:
            self._lose(now)
            return self._events(now)

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send bytes; without a line they are dropped."""
        if self._line is None or self._news:
            return
        try:
            self._line.write(address, payload, now)
            self.retry_at = self._line.retry_at
        except LostPort:
            self._lose(now)

    def flush(self, now: Nanoseconds) -> None:
        """Send what waits, or look whether the device is back."""
        if self._line is None:
            self._try(now)
            return
        try:
            self._line.flush(now)
            self.retry_at = self._line.retry_at
        except LostPort:
            self._lose(now)

    def close(self) -> None:
        """Close everything; never fails, and may be called again."""
        if self._line is not None:
            self._line.close()
            self._line = None
        for end in (self._quiet, self._bell):
            end.close()
        if self._fileno >= 0:
            with contextlib.suppress(OSError):
                os.close(self._fileno)
        self._fileno = -1

    def _lose(self, now: Nanoseconds) -> None:
        if self._line is not None:
            self._line.close()
        self._line = None
        self.retry_at = now + TRY_EVERY
        self._ring(LINE_LOST)

    def _try(self, now: Nanoseconds) -> None:
        try:
            self._line = SerialLine(self._device, self._baud)
        except PortError:
            self.retry_at = now + TRY_EVERY
            return
        self.retry_at = NEVER
        self._ring(LINE_BACK)

    def _ring(self, news: int) -> None:
        # dup2 exchanges the file behind a descriptor that others wait on, and its number stays.
        self._news.append(news)
        os.dup2(self._quiet.fileno(), self._fileno)
        self._bell.send(b"\0")

    def _events(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        events = [(news, b"") for news in self._news]
        self._quiet.recv(len(events))
        self._news.clear()
        if self._line is not None:
            os.dup2(self._line.fileno(), self._fileno)
        return events
