"""A serial line inside this machine: a pseudo-terminal, whose other end a client opens by its path.

The client may come and go. Bytes that it does not fetch are lost once the system keeps no more of them, as on
a line without a listener. A pseudo-terminal carries bytes at once, whatever its bit rate; but it knows the
one that the client has set: with another one than the device's nothing is received, either way.
"""

import contextlib
import os
import termios
import tty
from collections.abc import Callable
from pathlib import Path
from typing import Final

from firmware_bridge.runtime.ports.byte_file import ByteFile
from firmware_bridge.runtime.ports.port import PortError
from firmware_bridge.units import Nanoseconds

_ISPEED: Final = 4
_OSPEED: Final = 5
WORD: Final = "pty"
"""The users' word in place of a device."""


class PseudoTerminal(ByteFile):
    """This process's end of a line. `path` is the client's; a symbolic link to it is optional."""

    def __init__(
        self, link: Path | None = None, baud: int | None = None, say: Callable[[str], None] | None = None
    ) -> None:
        """Make it; PortError. `baud` is the device's rate, None for any; `say` takes what is wrong, once."""
        self._speed: Final = None if baud is None else getattr(termios, f"B{baud}", None)
        self._baud: Final = baud
        self._say = say
        super().__init__(self._made())
        self._link = link
        if link is not None:
            self._point(link)
        self.name = f"serial line {link or self.path}"

    def _made(self) -> int:
        """Make both ends, and return our own; PortError."""
        try:
            own, self._other = os.openpty()
            # Without this the system would echo our own bytes to us, and turn line feeds into two bytes.
            tty.setraw(self._other)
            if self._speed is not None:
                modes = termios.tcgetattr(self._other)
                modes[_ISPEED] = modes[_OSPEED] = self._speed
                termios.tcsetattr(self._other, termios.TCSANOW, modes)
            self.path = os.ttyname(self._other)
        except OSError as error:
            raise PortError(f"cannot make a pseudo-terminal: {error.strerror}") from error
        return own

    def read(self, now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return the bytes that have arrived, at the device's rate; LostPort."""
        received = super().read(now)
        return received if self._understood() else []

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send bytes; LostPort. At another rate than the client's they make no sense to it."""
        if self._understood():
            super().write(address, payload, now)

    def _understood(self) -> bool:
        """Return whether the client has the device's rate; say once where it has not."""
        # A pseudo-terminal carries bytes at any rate; on a real line another rate gives garbage.
        if self._speed is None or termios.tcgetattr(self._other)[_OSPEED] == self._speed:
            return True
        if self._say is not None:
            say, self._say = self._say, None
            say(f"{self.name}: its client has not set the device's {self._baud} Bd; nothing is received")
        return False

    def close(self) -> None:
        """Close both ends and remove the link; never fails, and may be called again."""
        self._vanish()
        self._link = None

    def _vanish(self) -> None:
        """Close both ends, and remove the link."""
        if self._link is not None and _leads_to(self._link, self.path):
            with contextlib.suppress(OSError):
                self._link.unlink()
        # Keeping the other end open, too, is what lets clients come and go.
        for fileno in (self._fileno, self._other):
            if fileno >= 0:
                with contextlib.suppress(OSError):
                    os.close(fileno)
        self._fileno = self._other = -1
        self._waiting.clear()

    def _crowded(self, waiting: bytearray) -> None:
        waiting.clear()

    def _point(self, link: Path) -> None:
        try:
            if link.is_symlink():
                link.unlink()  # of a run that was killed
            link.symlink_to(self.path)
        except OSError as error:
            self._link = None
            self.close()
            raise PortError(
                f"cannot make the link {link}: {error.strerror}; choose a path where nothing is yet"
            ) from error


def _leads_to(link: Path, path: str) -> bool:
    return link.is_symlink() and str(link.readlink()) == path
