"""A program of its own that draws the operator's picture: drawing never holds up what the station sends."""

import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Final

from firmware_bridge.runtime.ports.port import PortError
from firmware_bridge.units import NEVER, Nanoseconds

PROGRAM: Final = "firmware_bridge.cli.view_window"
READY: Final = "ready"
"""Its first line once it can draw; else why it cannot, in that line."""
ENDS_WITHIN_S: Final = 2.0


class ViewWindow:
    """Takes lines to draw; what cannot be drawn in time is left out, and a closed window is no loss."""

    def __init__(self, file: Path | None) -> None:
        """Open a window, or keep a picture file up to date; PortError where that cannot be."""
        self.name = "view"
        self.retry_at: Nanoseconds = NEVER
        words = [sys.executable, "-P", "-m", PROGRAM, *([] if file is None else [str(file)])]
        # Ctrl-C is for the station, which ends the window in its own order.
        self._program: Final = subprocess.Popen(  # noqa: S603 - our own program
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
        )
        if self._program.stdin is None or self._program.stdout is None:
            raise PortError("view: no pipe to the program that draws")
        first = self._program.stdout.readline().decode().strip()
        self._program.stdout.close()
        self._to: Final = self._program.stdin
        if first != READY:
            self._end()
            raise PortError(f"view: {first or 'the program that draws it ended at once'}")
        os.set_blocking(self._to.fileno(), False)
        self._silent, self._spare = os.pipe()
        """A file that never has anything to read: the window answers nothing."""

    def fileno(self) -> int:
        """Return a file that never becomes readable."""
        return self._silent

    def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        """Return nothing."""
        return []

    def write(self, _address: int, payload: bytes, _now: Nanoseconds) -> None:
        """Hand over a line; it is dropped where the program is behind, or closed by the user."""
        # A pipe takes a line as short as this whole, or not at all.
        with suppress(BlockingIOError, BrokenPipeError):
            os.write(self._to.fileno(), payload)

    def flush(self, _now: Nanoseconds) -> None:
        """Nothing waits here."""

    def close(self) -> None:
        """End the program; never fails, and may be called again."""
        if self._to.closed:
            return
        self._end()
        os.close(self._silent)
        os.close(self._spare)

    def _end(self) -> None:
        with suppress(OSError):
            self._to.close()
        try:
            self._program.wait(ENDS_WITHIN_S)
        except subprocess.TimeoutExpired:
            self._program.kill()
            self._program.wait()
