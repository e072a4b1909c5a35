"""The keys of the terminal that the program was started in, one by one as they go down, and not shown."""

import os
import sys
import termios
import tty
from contextlib import suppress
from typing import Final

from firmware_bridge.runtime.ports.byte_file import ByteFile
from firmware_bridge.runtime.ports.port import PortError


class KeyboardPort(ByteFile):
    """The terminal's keys; Ctrl-C stays what it is. PortError where there is no terminal."""

    name = "keyboard"

    def __init__(self, fileno: int | None = None) -> None:
        """Take the keys of a terminal, or those of standard input."""
        given = sys.stdin.fileno() if fileno is None else fileno
        if not os.isatty(given):
            raise PortError(
                "there is no keyboard: standard input is no terminal; start the program without a pipe"
            )
        self._before: Final = termios.tcgetattr(given)
        # A file of its own: that it never waits must not hold for what else has the terminal open.
        super().__init__(os.open(os.ttyname(given), os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY))
        tty.setcbreak(self._fileno, termios.TCSANOW)
        self._closed = False

    def close(self) -> None:
        """Give the terminal back as it was; never fails, and may be called again."""
        if self._closed:
            return
        self._closed = True
        with suppress(OSError, termios.error):  # a terminal may be gone
            termios.tcsetattr(self._fileno, termios.TCSANOW, self._before)
        os.close(self._fileno)

    def _crowded(self, waiting: bytearray) -> None:
        """Nothing is ever written to it."""
