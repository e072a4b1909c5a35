"""Signals as a file that can be waited for, so that a run ends in good order on any of them."""

import signal
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Final

ENDING: Final = (
    "SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGPIPE", "SIGTSTP",
    "SIGXCPU", "SIGALRM", "SIGUSR1", "SIGUSR2",
)  # fmt: skip
"""Each of them would end or suspend the process at once: a terminal that is closed, Ctrl-\\, Ctrl-Z, a pipe
that no one reads any more. What this system lacks is left out."""
_UNHEEDED: Final = ("SIGTTIN", "SIGTTOU")
"""Signals that suspend a process in the background that reads from its terminal, or writes to it."""


class Bell:
    """A bell that rings for each signal to end."""

    def __init__(self, reader: socket.socket) -> None:
        self._reader = reader
        self.fileno = reader.fileno()

    def rung(self) -> bytes:
        """Return the numbers of the signals that came, in order."""
        with suppress(BlockingIOError):
            return self._reader.recv(64)
        return b""


@contextmanager
def ringing() -> Iterator[Bell]:
    """Let the signals ring while this runs; only the main thread can, elsewhere nothing rings.

    A hang-up that was ignored before (nohup) is ignored.
    """
    reader, writer = socket.socketpair()
    with reader, writer:
        reader.settimeout(0)
        writer.settimeout(0)
        if threading.current_thread() is not threading.main_thread():
            yield Bell(reader)
            return
        # The number goes through a socket: a handler may run between any two instructions of the node.
        wakeup = signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
        # A handler is needed even so: without one the default action would end the process.
        before = {number: signal.signal(number, _received) for number in _numbers(ENDING) if _counts(number)}
        before |= {number: signal.signal(number, signal.SIG_IGN) for number in _numbers(_UNHEEDED)}
        try:
            yield Bell(reader)
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
            signal.set_wakeup_fd(wakeup)


def _numbers(names: tuple[str, ...]) -> list[signal.Signals]:
    return [signal.Signals[name] for name in names if name in signal.Signals.__members__]


def _counts(number: signal.Signals) -> bool:
    return number.name != "SIGHUP" or signal.getsignal(number) is not signal.SIG_IGN


def _received(_number: int, _frame: FrameType | None) -> None:
    """Do nothing: the number was written to the bell before this is called."""
