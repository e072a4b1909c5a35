"""A pseudo-terminal that reports its client's opening and closing, as DTR does on a serial line.

A pseudo-terminal has no such wire. But Linux raises DTR when a port is opened and drops it when it is closed
for the last time, and reports (inotify) that a file was opened or closed. Several events reported at once
count as one, so of two clients the second's opening may be missed, which raises nothing.
"""

import ctypes
import fcntl
import os
import select
import struct
import termios
from collections.abc import Callable
from pathlib import Path
from typing import Final

from firmware_bridge.node import DTR_DOWN, DTR_UP, LINE_BACK, LINE_LOST
from firmware_bridge.runtime.ports.port import PortError
from firmware_bridge.runtime.ports.pseudo_terminal import PseudoTerminal
from firmware_bridge.units import Nanoseconds

_OPENED: Final = 0x20
_CLOSED: Final = 0x08 | 0x10
_EVENT: Final = struct.Struct("iIII")
_ROOM: Final = 4_096
_CFLAG: Final = 2


class SeenOpening(PseudoTerminal):
    """The end that this process speaks on; packets with the addresses `DTR_UP` and `DTR_DOWN` are empty."""

    def __init__(
        self,
        link: Path | None = None,
        baud: int | None = None,
        say: Callable[[str], None] | None = None,
        *,
        reports_dtr: bool = True,
    ) -> None:
        """Make it; PortError. Without `reports_dtr` it reports no clients."""
        self._watch = -1
        self._both: select.epoll | None = None
        super().__init__(link, baud, say)
        self._reports_dtr: Final = reports_dtr
        self._clients = 0
        self._look()

    def _look(self) -> None:
        """See who opens it from now on; PortError."""
        if self._reports_dtr:
            _drop_at_close(self._other)
        self._clients = 0
        try:
            self._both = both = self._both or select.epoll()
            self._watch = _watch(self.path)
        except (OSError, AttributeError) as error:
            self.close()
            raise PortError(
                f"cannot see who opens {self.name}: {error}; only Linux shows it; omit --reset-on-open"
            ) from error
        for fileno in (self._watch, self._fileno):
            both.register(fileno, select.EPOLLIN)

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send bytes; LostPort. `LINE_LOST` pulls the cable: the port is gone until `LINE_BACK`."""
        if address == LINE_LOST:
            self._look_away()
            self._vanish()
        elif address == LINE_BACK:
            self._fileno = self._made()
            os.set_blocking(self._fileno, False)
            if self._link is not None:
                self._point(self._link)
            self._look()
            self._announce()
        elif self._fileno >= 0:
            super().write(address, payload, now)

    def _announce(self) -> None:
        if self._link is None and self._say is not None:
            self._say(f"{self.name} is plugged in again, as {self.path}")

    def fileno(self) -> int:
        """Return a file that can be read when bytes have arrived, or a client has come or gone."""
        return -1 if self._both is None else self._both.fileno()

    def read(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return bytes, and before them what became of DTR."""
        ready = {fileno for fileno, _ in self._both.poll(0)} if self._both is not None else set()
        news = [(it, b"") for it in self._news()] if self._watch in ready else []
        return news + (super().read(now) if self._fileno in ready else [])

    def close(self) -> None:
        """Close all; never fails, and may be called again."""
        self._look_away()
        if self._both is not None:
            self._both.close()
            self._both = None
        super().close()

    def _look_away(self) -> None:
        if self._watch >= 0:
            os.close(self._watch)
            self._watch = -1

    def _news(self) -> list[int]:
        events = os.read(self._watch, _ROOM)
        # A client that locks the port leaves it locked, since this end is never closed.
        fcntl.ioctl(self._other, termios.TIOCNXCL)
        found = []
        for _, mask, _, _ in _EVENT.iter_unpack(events):
            before = self._clients
            # Never below 0: a closing without an opening that was seen may be of a client from before.
            self._clients = max(0, before + (1 if mask & _OPENED else -1))
            if not before and self._clients:
                found.append(DTR_UP)
            elif before and not self._clients and self._drops():
                found.append(DTR_DOWN)
        return found if self._reports_dtr else []

    def _drops(self) -> bool:
        """Return whether the last close drops DTR, as it does unless the client has set otherwise."""
        cflag = termios.tcgetattr(self._other)[_CFLAG]
        return bool(cflag & termios.HUPCL)


def _drop_at_close(terminal: int) -> None:
    """Set what a serial port has from the beginning, and a pseudo-terminal has not."""
    modes = termios.tcgetattr(terminal)
    modes[_CFLAG] |= termios.HUPCL
    termios.tcsetattr(terminal, termios.TCSANOW, modes)


def _watch(path: str) -> int:
    """Return a file of a path's opening and closing events; OSError, or AttributeError where none exists."""
    library = ctypes.CDLL(None, use_errno=True)
    watch: int = library.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
    if watch < 0 or library.inotify_add_watch(watch, os.fsencode(path), _OPENED | _CLOSED) < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return watch
