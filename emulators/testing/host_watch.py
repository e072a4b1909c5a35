"""A watch over the machine itself: a test in real time that fails on a machine that was late shows nothing.

The limit is --late-after, 0.1 s by default (assumed): no heartbeat or watchdog of a device is much shorter.
On a quiet machine a thread is late by less than 1 ms.
"""

from collections.abc import Iterable
from contextlib import suppress
from threading import Thread
from typing import Final

from emulators.testing.process import Process
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.testing.control import ControlError, of_process
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

EVERY: Final[Nanoseconds] = 5 * MILLISECOND


class HostWatch:
    """A thread that measures how much too late it is woken, until it is ended."""

    def __init__(self) -> None:
        """Start it."""
        self.worst_s = 0.0
        """The longest delay so far."""
        self._ended = False
        self._thread: Final = Thread(target=self._watch, name="host watch", daemon=True)
        self._thread.start()

    def end(self) -> None:
        """End it."""
        self._ended = True
        self._thread.join()

    def _watch(self) -> None:
        clock = Clock()
        while not self._ended:
            due = clock.now() + EVERY
            clock.wait((), due)
            self.worst_s = max(self.worst_s, to_seconds(clock.now() - due))


def lateness(watch: HostWatch, processes: Iterable[Process], limit_s: float) -> str:
    """Return by how much the machine was late in this test; empty where it was in time, or the limit is 0."""
    if not limit_s:
        return ""
    found = []
    if watch.worst_s >= limit_s:
        found.append(f"this process was not run for {watch.worst_s:.2f} s")
    for process in processes:
        if process.status is None:
            # A program that is no emulation has no control port.
            with suppress(ControlError), of_process(process.pid) as control:
                stalled_s = float(control.state()["stalled_s"])
                if stalled_s >= limit_s:
                    found.append(f"emulated devices were not run for {stalled_s:.2f} s")
    return f"{', '.join(found)}, limit {limit_s:g} s" if found else ""
