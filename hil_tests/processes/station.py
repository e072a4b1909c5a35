"""A station of pymavlink's in a thread: it sends heartbeats, holds its stick, and receives."""

import socket
import threading
import time
from contextlib import suppress
from typing import Any, Final

from pymavlink.dialects.v20 import common as mavlink

from hil_tests.ports import free_port

EVERY_S: Final = 0.05
REQUEST_CONTROL: Final = 32100
STOP: Final = 21196
"""The magic number of a forced disarm."""


class _Wire:
    """Output of pymavlink."""

    def __init__(self, outside: socket.socket, place: tuple[str, int]) -> None:
        self._outside = outside
        self._place = place

    def write(self, datagram: bytes) -> None:
        with suppress(OSError):  # no one is there yet, or any more
            self._outside.sendto(datagram, self._place)


class Station:
    """Station for a bridge that waits on `port`."""

    def __init__(self, port: int | None = None, system: int = 255) -> None:
        """Speak to a bridge at a port of its own, or at this one."""
        self.port: Final[int] = free_port() if port is None else port
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(0.0)
        self._link = mavlink.MAVLink(_Wire(self._socket, ("127.0.0.1", self.port)), system, 190)
        self._link.robust_parsing = True
        self._lock = threading.Lock()
        self._ends = threading.Event()
        self.stick = 0
        self.throttle = 0
        """Rest position of its z."""
        self.armed = False
        self.x_m = 0.0
        """Position in the newest odometry."""
        self.texts: list[str] = []
        self._thread = threading.Thread(target=self._work, daemon=True)

    def begin(self) -> None:
        self._thread.start()

    def end(self) -> None:
        self._ends.set()
        self._thread.join()
        self._socket.close()

    def closes(self) -> None:
        """Close it, where it was never begun."""
        self._socket.close()

    def lives(self) -> None:
        """Show that it lives, once."""
        with self._lock:
            self._link.heartbeat_send(6, 8, 0, 0, 0)

    def requests(self, command: int, *fields: float) -> None:
        """Send a command."""
        with self._lock:
            self._link.command_long_send(1, 1, command, 0, *(*fields, *(0.0,) * (7 - len(fields))))

    def stops(self) -> None:
        """Order an emergency stop, and a forced disarm, as some stations do."""
        self.requests(mavlink.MAV_CMD_DO_FLIGHTTERMINATION, 1)
        self.requests(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0, STOP)

    def lets_anybody_drive(self) -> None:
        """Give the control away, and take it where another one has: MAV_CMD_REQUEST_OPERATOR_CONTROL."""
        self.requests(REQUEST_CONTROL, 1, 1)

    def _work(self) -> None:
        beats = 0
        while not self._ends.wait(EVERY_S):
            with self._lock:
                self._link.manual_control_send(1, self.stick, 0, self.throttle, 0, 0)
                if beats % 20 == 0:
                    self._link.heartbeat_send(6, 8, 0, 0, 0)
                beats += 1
            self._receive()

    def _receive(self) -> None:
        with suppress(OSError):
            while True:
                for message in self._link.parse_buffer(self._socket.recv(2048)) or ():
                    self._take(message)

    def _take(self, message: Any) -> None:
        kind = message.get_type()
        if kind == "HEARTBEAT":
            self.armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
        elif kind == "ODOMETRY":
            self.x_m = message.x
        elif kind == "STATUSTEXT":
            self.texts.append(message.text)
        elif kind == "TIMESYNC" and message.tc1 == 0:
            with self._lock:
                self._link.timesync_send(time.monotonic_ns(), message.ts1)
