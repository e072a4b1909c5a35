"""A serial line inside this machine: a pseudo-terminal, whose other end a client opens by its path.

The client may come and go. What it does not fetch is thrown away once the system keeps no more of it, as on a
line at whose end nobody listens. A pseudo-terminal has no bit rate: bytes arrive at once.
"""

import contextlib
import os
import tty
from pathlib import Path
from typing import Final

from firmware_bridge.shell.ports.byte_file import ByteFile
from firmware_bridge.shell.ports.port import PortError

WORD: Final = "pty"
"""What users write in place of a device."""


class PseudoTerminal(ByteFile):
    """The end that this process speaks on. `path` is the client's; a symbolic link to it may be asked for."""

    def __init__(self, link: Path | None = None) -> None:
        try:
            own, self._other = os.openpty()
            # Without this the system would echo our own bytes to us, and turn line feeds into two bytes.
            tty.setraw(self._other)
            self.path = os.ttyname(self._other)
        except OSError as error:
            raise PortError(f"cannot make a pseudo-terminal: {error.strerror}") from error
        super().__init__(own)
        self._link = link
        if link is not None:
            self._point(link)
        self.name = f"serial line {link or self.path}"

    def close(self) -> None:
        """Close both ends and remove the link; never fails, and may be called again."""
        if self._link is not None and _leads_to(self._link, self.path):
            with contextlib.suppress(OSError):
                self._link.unlink()
        self._link = None
        # Keeping the other end open, too, is what lets clients come and go.
        for fileno in (self._fileno, self._other):
            if fileno >= 0:
                with contextlib.suppress(OSError):
                    os.close(fileno)
        self._fileno = self._other = -1

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
