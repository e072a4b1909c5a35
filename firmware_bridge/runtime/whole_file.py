"""A small file that is replaced whole, by a thread: a crash leaves the old one or the new one.

No disk holds up who keeps something in it: the newest text counts, whatever became of those before.
"""

import os
from contextlib import suppress
from pathlib import Path
from threading import Condition, Thread
from typing import Final

from firmware_bridge.units import SECOND, Nanoseconds, to_seconds

STALLS: Final[Nanoseconds] = 5 * SECOND
"""Time after which a text that is not on the disk is reported."""
ENDS_WITHIN_S: Final = 2.0
"""So long at most the end of a run waits for the disk."""


class WholeFile:
    """One file; `replace` never waits and never fails."""

    def __init__(self, path: Path) -> None:
        self.path: Final = path
        self._changed = Condition()
        self._newest: str | None = None
        self._requested: str | None = None
        self._works = False
        """True while a thread is at work."""
        self._since: Nanoseconds = 0
        self._failure: str | None = None

    def replace(self, text: str, now: Nanoseconds) -> None:
        """Have the file replaced."""
        with self._changed:
            # After a failure the same text is tried again.
            if text == self._requested and self._failure is None:
                return
            self._newest = self._requested = text
            if self._works:
                return
            self._works, self._since = True, now
        Thread(target=self._work, name=f"writing {self.path}", daemon=True).start()

    def problem(self, now: Nanoseconds) -> str | None:
        """Return why the last requested text is not on the disk; None where it is, or may be soon."""
        if self._works and now - self._since >= STALLS:
            return f"{self.path}: the disk takes nothing for {to_seconds(now - self._since):.0f} s"
        return None if self._failure is None else f"{self.path}: {self._failure}"

    def settled(self, within_s: float = ENDS_WITHIN_S) -> str | None:
        """Wait until all is on the disk, so long at most; return what hinders it."""
        with self._changed:
            if not self._changed.wait_for(lambda: not self._works, within_s):
                return f"{self.path}: the disk takes nothing within {within_s:g} s"
        return self.problem(self._since)

    def _work(self) -> None:
        """Write until nothing newer has come; the thread's whole life."""
        while True:
            with self._changed:
                text, self._newest = self._newest, None
                if text is None:
                    self._works = False
                    self._changed.notify_all()
                    return
            try:
                _replace(self.path, text)
            except OSError as error:
                self._failure = error.strerror or str(error)
            else:
                self._failure = None


def _replace(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f"{path.name}.{os.getpid()}")
    try:
        fresh.write_text(text, encoding="utf-8")
        # Replacing within one folder is atomic: a reader finds the old file or the new one.
        fresh.replace(path)
    except OSError:
        with suppress(OSError):
            fresh.unlink()
        raise
