"""Prints from a thread of its own: no terminal, pager or disk that takes nothing holds up who speaks.

What it cannot print is dropped and counted, and how much it was is printed as soon as something is taken
again. A pipe that no one reads any more raises SIGPIPE in the process, as ever.
"""

import os
import select
from contextlib import suppress
from queue import Empty, Full, Queue
from threading import Lock, Thread
from typing import Final, TextIO

MOST: Final = 2_000
"""So many lines at most wait to be printed."""


class Printer:
    """Lines on their way to files; `print` never waits and never fails."""

    def __init__(self) -> None:
        self._waiting: Queue[tuple[int, bytes] | None] = Queue(MOST)
        self._lost = 0
        """Lines that found no place to wait in; this end's count, which only grows."""
        self._failed = 0
        """Lines that nothing took; the thread's count."""
        self._lost_reported = 0
        self._counting = Lock()
        """Held while a line is dropped: what is printed after it has it in its count."""
        self._thread: Thread | None = None

    @property
    def printing(self) -> bool:
        """True while its thread is at work."""
        return self._thread is not None and self._thread.is_alive()

    def print(self, text: str, stream: TextIO) -> None:
        """Let a line be printed."""
        try:
            fileno = stream.fileno()
        except (OSError, ValueError):
            # In memory it takes at once whatever it is given; one that is closed takes nothing.
            with suppress(ValueError):
                stream.write(f"{text}\n")
            return
        try:
            line = f"{text}\n".encode(stream.encoding, stream.errors or "strict")
        except UnicodeError:
            line = f"{text}\n".encode(stream.encoding, "replace")
        if self._thread is None:
            self._thread = Thread(target=self._work, name="printing", daemon=True)
            self._thread.start()
        try:
            # A terminal that is stopped by Ctrl-S takes nothing; the caller may be the bridge's cycle.
            self._waiting.put_nowait((fileno, line))
        except Full:
            self._lost += 1

    def end(self, within_s: float) -> None:
        """Wait for what is still to be printed, so long at most, or until Ctrl-C; drop the rest."""
        thread = self._thread
        if thread is None:
            return
        try:
            while True:
                try:
                    self._waiting.put_nowait(None)
                except Full:  # nothing is taken; one line less is printed
                    self._drop_one()
                else:
                    break
            thread.join(within_s)
        except KeyboardInterrupt:
            return

    def _drop_one(self) -> None:
        with self._counting:
            try:
                self._waiting.get_nowait()
            except Empty:
                return
            self._lost += 1

    def _work(self) -> None:
        """Print what waits; the thread's whole life."""
        while (item := self._waiting.get()) is not None:
            fileno, line = item
            with self._counting:
                missing = self._lost + self._failed - self._lost_reported
            if missing:
                line = f"({missing} lines before this one could not be printed)\n".encode() + line
            if _written(fileno, line):
                self._lost_reported += missing
            else:
                self._failed += 1


def _written(fileno: int, line: bytes) -> bool:
    """Write all of a line, however long that takes; return whether it was taken."""
    while line:
        try:
            line = line[os.write(fileno, line) :]
        except BlockingIOError:
            select.select((), (fileno,), ())
        except OSError:
            return False
    return True
