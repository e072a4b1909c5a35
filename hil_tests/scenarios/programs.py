"""The program's commands as processes of their own, in real time; a loaded machine takes its time."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import IO, Final

from firmware_bridge.shell.clock import Clock
from firmware_bridge.units import MILLISECOND, SECOND

PROGRAM = Path(sys.executable).with_name("firmware-bridge")
WITHIN: Final = 30 * SECOND
"""A loaded machine takes its time; nothing here is measured."""


class Program:
    """One run of the program, and everything that it has said."""

    def __init__(self, log: Path, *words: str) -> None:
        self._log = log
        self._file: IO[str] = log.open("w", encoding="utf-8")
        environment = os.environ | {"PYTHONUNBUFFERED": "1"}
        self.process = subprocess.Popen(
            [PROGRAM, *words], stdout=self._file, stderr=subprocess.STDOUT, env=environment
        )

    @property
    def told(self) -> str:
        return self._log.read_text(encoding="utf-8")

    def says(self, text: str) -> bool:
        return text in self.told

    def ends(self) -> int:
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(timeout=20)

    def dies(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._file.close()


def until(met: Callable[[], bool], what: Callable[[], str], meanwhile: Callable[[], None]) -> None:
    clock = Clock()
    while not met():
        assert clock.now() < WITHIN, what()
        meanwhile()
        clock.wait([], clock.now() + 50 * MILLISECOND)


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
