"""A program under test, or one that serves it: started, watched, ended; what it prints is kept."""

import shlex
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

LOOK_EVERY_S: Final = 0.05
KILLED_AFTER_S: Final = 5.0
"""So long a program that was asked to end may take over it."""
TOLD: Final = 4000
"""So many of the last characters that it printed stand in an error."""


class Process:
    """One program; AssertionError, with what it printed, for all that it does not do in time."""

    def __init__(self, command: str | Sequence[str], log: Path) -> None:
        """Start it; its output goes to `log`. OSError where there is no such program."""
        self.command: Final = shlex.split(command) if isinstance(command, str) else list(command)
        self.log: Final = log
        with log.open("wb") as out:
            self._process: Final = subprocess.Popen(  # noqa: S603 - the user names it
                self.command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT
            )

    @property
    def printed(self) -> str:
        """What it has printed so far, errors included."""
        return self.log.read_text(encoding="utf-8", errors="replace")

    @property
    def status(self) -> int | None:
        """Its exit status; None while it runs."""
        return self._process.poll()

    def says(self, text: str, within: float = 10.0) -> None:
        """Wait until it has printed this."""
        self.waits(lambda: text in self.printed, f"'{text}' printed", within)

    def waits(self, what: Callable[[], object], called: str, within: float) -> None:
        """Wait until something is so, looked at every 50 ms; it may end before only where it is so then."""
        for _ in range(max(1, round(within / LOOK_EVERY_S))):
            if what():
                return
            try:
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
        """End it at once, as a loss of power does: it says nothing any more. Harmless where it has ended."""
        self._process.kill()
        self._process.wait()

    def stop(self) -> None:
        """End it where it still runs: it is asked first."""
        if self.status is None:
            self._process.terminate()
            try:
                self._process.wait(KILLED_AFTER_S)
            except subprocess.TimeoutExpired:
                self.kill()

    def failed(self, what: str) -> AssertionError:
        """Return the error that says what it did not do, and what it printed."""
        return AssertionError(f"{shlex.join(self.command)}: {what}; it printed:\n{self.printed[-TOLD:]}")
