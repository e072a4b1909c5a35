"""Numbers of UDP ports for tests that name one before a program opens it."""

import os
import socket
import threading
from itertools import count
from typing import Final

LOOPBACK: Final = "127.0.0.1"
FIRST: Final = 10_000
COUNT: Final = 20_000
"""Below those that a system hands out by itself: no socket of someone else comes upon one meanwhile."""
SPREAD: Final = 97
"""Distance of the first numbers of two processes that began one after the other."""


class Ports:
    """Free numbers of this process, each given once."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._numbers: Final = count(os.getpid() * SPREAD)

    def free(self) -> int:
        """Return a number that is in use by no one."""
        while True:
            with self._lock:
                number = FIRST + next(self._numbers) % COUNT
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
                try:
                    probe.bind((LOOPBACK, number))
                except OSError:
                    continue
                return number


free_port: Final = Ports().free
