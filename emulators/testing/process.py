"""A program under test, or one that serves it: started, watched, ended; what it prints is kept."""

import ctypes
import os
import shlex
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Final

from firmware_bridge.renamed import warn

LOOK_EVERY_S: Final = 0.05
KILLED_AFTER_S: Final = 5.0
"""Time that a program may take to end after the request."""
SET_DEATH_SIGNAL: Final = 1
"""`prctl`'s PR_SET_PDEATHSIG."""
SHOWN: Final = 4000
"""Number of the last printed characters that are in an error."""


def _ends_with(parent: int) -> None:
    """Let the system end this process when its parent is gone: a killed one leaves no process behind."""
    ctypes.CDLL(None).prctl(SET_DEATH_SIGNAL, signal.SIGTERM)
    # The parent may have ended before `prctl`: no signal comes for that.
    if os.getppid() != parent:
        os.kill(os.getpid(), signal.SIGTERM)


class Process:
    """One program, which ends with its parent on Linux.

    AssertionError, with what it printed, for all that it does not do in time.
    """

    def __init__(self, command: str | Sequence[str], log: Path) -> None:
        """Start it; its output goes to `log`. OSError where there is no such program."""
        self.command: Final = shlex.split(command) if isinstance(command, str) else list(command)
        self.log: Final = log
        with log.open("wb") as out:
            self._process: Final = subprocess.Popen(  # noqa: S603 - the user names it; one thread forks
                self.command,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
                preexec_fn=partial(_ends_with, os.getpid()) if sys.platform == "linux" else None,  # noqa: PLW1509 - one thread forks
            )

    @property
    def printed(self) -> str:
        """Its output so far, errors included."""
        return self.log.read_text(encoding="utf-8", errors="replace")

    @property
    def pid(self) -> int:
        """Its number at the system."""
        return self._process.pid

    @property
    def status(self) -> int | None:
        """Its exit status; None while it runs."""
        return self._process.poll()

    def prints(self, text: str, within: float = 10.0) -> None:
        """Wait until it has printed this."""
        self.waits(lambda: text in self.printed, f"'{text}' printed", within)

    def says(self, text: str, within: float = 10.0) -> None:
        """Do as `prints`, by its old name."""
        warn("says", "prints", "Process")
        self.prints(text, within)

    def waits(self, what: Callable[[], object], called: str, within: float) -> None:
        """Wait until something is so, looked at every 50 ms; it may end before only where it is so then."""
        for _ in range(max(1, round(within / LOOK_EVERY_S))):
            if what():
                return
            try:
                # Not a sleep: the end of the program is noticed at once.
                self._process.wait(LOOK_EVERY_S)
            except subprocess.TimeoutExpired:
                continue
            if what():
                return
            raise self.failed(f"ended with {self.status}, not {called}")
        raise self.failed(f"not {called} within {within:g} s")

    def ends(self, within: float = 10.0) -> int:
        """Wait for its end and return its exit status."""
        try:
            return self._process.wait(within)
        except subprocess.TimeoutExpired:
            raise self.failed(f"still runs after {within:g} s") from None

    def kill(self) -> None:
        """Kill it at once, as a loss of power does: its output ends. Harmless where it has ended."""
        self._process.kill()
        self._process.wait()

    def stop(self) -> None:
        """End it where it still runs: first by a request to terminate."""
        if self.status is None:
            # SIGTERM first: a bridge stops its robot in order before it ends.
            self._process.terminate()
            try:
                self._process.wait(KILLED_AFTER_S)
            except subprocess.TimeoutExpired:
                self.kill()

    def failed(self, what: str) -> AssertionError:
        """Return the error that names the missing event, with the printed output."""
        return AssertionError(f"{shlex.join(self.command)}: {what}; it printed:\n{self.printed[-SHOWN:]}")
