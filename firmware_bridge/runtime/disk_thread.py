"""Thread that brings a recording to the disk, so that no disk holds up a cycle.

A disk that is full, slow or gone ends the recording with one message, and never the robot.
"""

from collections import deque
from collections.abc import Callable
from pathlib import Path
from threading import Event, Thread
from typing import Final, Generic, TypeVar

MOST: Final = 100_000
"""So many rows at most wait for the disk: some ten seconds of a bus of 1 Mbit/s that is never idle."""
EVERY_S: Final = 0.2
END_WITHIN_S: Final = 5.0
T = TypeVar("T")


class DiskThread(Generic[T]):
    """Rows on their way to a disk. `put` never waits and never fails."""

    def __init__(
        self,
        place: Path,
        say: Callable[[str], None],
        write: Callable[[deque[T]], None],
        close: Callable[[], None],
    ) -> None:
        """Take the name of the recording, the user's output, and what the thread does.

        `write` takes all rows that wait, every 0.2 s and at the end; `close` comes last. OSError of either
        ends the recording.
        """
        self._place: Final = place
        self._say: Final = say
        self._write: Final = write
        self._close: Final = close
        self._waiting: Final[deque[T]] = deque()
        self._failure: str | None = None
        self._reported = False
        self._ending: Final = Event()
        self._thread: Final = Thread(target=self._run, name=f"recording in {place}", daemon=True)
        self._thread.start()

    def put(self, row: T) -> None:
        """Take a row."""
        if self._failure is None:
            # A bound on the memory: a disk that hangs must not let the queue grow for ever.
            if len(self._waiting) < MOST:
                self._waiting.append(row)
            else:
                self._failure = "the disk is too slow"
        self._report_failure()

    def end(self) -> None:
        """Bring what waits to the disk, and say so where that failed."""
        self._ending.set()
        self._thread.join(END_WITHIN_S)
        if self._thread.is_alive():
            self._failure = f"the disk takes nothing within {END_WITHIN_S:g} s"
        self._report_failure()

    def _report_failure(self) -> None:
        if self._failure is not None and not self._reported:
            self._reported = True
            # Nothing more is written, so what waits would only take memory.
            self._waiting.clear()
            self._say(f"recording in {self._place} has ended: {self._failure}; the run goes on")

    def _run(self) -> None:
        """Write what waits, until the end; the thread's whole life."""
        try:
            while not self._ending.wait(EVERY_S):
                self._write(self._waiting)
            self._write(self._waiting)
        except OSError as error:
            self._failure = error.strerror or str(error)
        finally:
            self._closed()

    def _closed(self) -> None:
        try:
            self._close()
        except OSError as error:
            # A failure before it is the cause, and was noted.
            self._failure = self._failure or error.strerror or str(error)
