"""Two processes, as a user starts them, and a station: the robot's motion when one of them ends.

The emulator's plant writes to a file how far each axis has turned: the motion itself is judged, not any
report of it.
"""

import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from pymavlink.dialects.v20 import common as mavlink

from hil_tests.processes.station import Station

EMULATOR: Final = """
import math, os, sys, threading, time
import emulators.devices as bench
import firmware_bridge.cli.real_time as real_time
from emulators.arduino_omni.ar2.board import Ar2Board
from firmware_bridge.cli import main
from firmware_bridge.packet import Packet, Reaction
truth, *sys.argv[1:] = sys.argv[1:]
def writes(turned):
    def write():
        with open(truth, "w", buffering=1) as file:
            while True:
                file.write(f"{time.monotonic():.3f} " + " ".join(f"{one:.5f}" for one in turned()) + chr(10))
                time.sleep(0.02)
    threading.Thread(target=write, daemon=True).start()
made, begun = bench.devices, Ar2Board.__init__
def devices(*names, **more):
    found = made(*names, **more)
    of_axes = [place for place, name in enumerate(found.plant.output_names) if name.startswith("angle_")]
    writes(lambda: [found.plant.outputs[place] for place in of_axes])
    return found
def board(self, *given, **more):
    begun(self, *given, **more)
    if sys.argv[2] == "ar2":
        writes(lambda: [math.radians(angle) for angle in self.joints.angles])
class Chattering:
    def __init__(self, node):
        self.node, self.since, self.next = node, None, 0
    def receive(self, packet, now):
        dead = self.since is not None and now < self.since + 1_500_000_000
        return self.shown(self.node.wake(now) if dead else self.node.receive(packet, now), now)
    def wake(self, now):
        return self.shown(self.node.wake(now), now)
    def shown(self, reaction, now):
        if self.since is None:
            self.since = now if os.path.exists(truth + ".chatters") else None
            return reaction
        if now < self.since + 1_500_000_000:
            return Reaction((), reaction.wake_at)
        sent = reaction.sent
        if now >= self.next:
            self.next = now + 20_000_000
            sent += (Packet("serial", 0, b"debug 1" + bytes((13, 10))),)
        return Reaction(sent, min(reaction.wake_at, self.next))
carried = real_time.carry
real_time.carry = lambda node, *given, **more: carried(Chattering(node), *given, **more)
bench.devices, Ar2Board.__init__ = devices, board
main()
"""
BRIDGE: Final = """
import fcntl, os, signal, termios
signal.signal(signal.SIGHUP, signal.SIG_IGN if "IGNORES_HANG_UPS" in os.environ else signal.SIG_DFL)
if os.isatty(1):
    fcntl.ioctl(1, termios.TIOCSCTTY, 0)
from firmware_bridge.cli import main
main()
"""
"""It does not inherit an ignored hang-up from the test runner; its terminal is its own."""
STARTS_WITHIN_S: Final = 90.0
"""On a busy machine; what is awaited comes within seconds else."""
WINDOW_S: Final = 0.1


@dataclass(frozen=True)
class Row:
    """One robot over one protocol."""

    name: str
    words: tuple[str, ...] = ()
    """Options for both commands."""
    bridge: tuple[str, ...] = ()
    """Options for the bridge alone."""
    lines: tuple[str, ...] = ()
    """Its links on pseudo-terminals; none: on a bus."""
    stick: int = 600
    """Stick position in thousandths."""
    turns_rad_s: float = 2.0
    """A motor that is slower stands; an arm is known by its joints."""


def zeros(**places: float) -> tuple[str, ...]:
    return tuple(word for name, place in places.items() for word in ("--zero", f"{name}={place:g}"))


@dataclass
class Pair:
    """An emulator, and a bridge to it."""

    row: Row
    folder: Path
    stdout: Any = None
    ignores_hang_ups: bool = False
    station: Station = field(init=False)

    def __post_init__(self) -> None:
        self.truth = self.folder / "truth"
        self.log = self.folder / "bridge.log"
        self.emulator = self._emulator()
        places = self._places()
        self.station = Station()
        words = [
            *("drive", self.row.name, *places, *self.row.words, *self.row.bridge),
            *(
                "--mavlink",
                f"udpin:127.0.0.1:{self.station.port}",
                "--state",
                str(self.folder / "state.json"),
            ),
        ]
        out = self.log.open("wb") if self.stdout is None else self.stdout
        self.bridge = subprocess.Popen(
            [sys.executable, "-u", "-c", BRIDGE, *words],
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env={**os.environ, **({"IGNORES_HANG_UPS": "1"} if self.ignores_hang_ups else {})},
        )
        if self.stdout is None:
            out.close()
        self.station.begin()

    def _emulator(self) -> "subprocess.Popen[bytes]":
        if not self.row.lines:
            place = self._bus
        elif len(self.row.lines) == 1:
            place = ("--serial", "pty")
        else:
            place = tuple(word for line in self.row.lines for word in ("--link", f"{line}=serial:pty"))
        with (self.folder / "emulator.log").open("wb") as out:
            return subprocess.Popen(
                [
                    *(sys.executable, "-u", "-c", EMULATOR, str(self.truth)),
                    *("emulate", self.row.name, *place, *self.row.words),
                ],
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    @property
    def _bus(self) -> tuple[str, ...]:
        return ("-i", "loopback_multicast", "-c", "239.74.163.2")

    def _places(self) -> tuple[str, ...]:
        """Wait until the emulator prints its places; return the bridge's words for them."""

        def stated() -> list[str]:
            return re.findall(r"/dev/pts/\d+", (self.folder / "emulator.log").read_text())

        awaited(lambda: "ends it" in (self.folder / "emulator.log").read_text(), "the emulator is there")
        lines = self.row.lines
        if not lines:
            return self._bus
        if len(lines) == 1:
            return ("--serial", stated()[0])
        return tuple(
            w for name, at in zip(lines, stated(), strict=False) for w in ("--link", f"{name}=serial:{at}")
        )

    def drives(self) -> None:
        """Arm it, and let it drive until its axes turn; on a busy machine as often as that takes."""

        def turns() -> bool:
            if not self.station.armed:
                self.station.stick = 0
                self.station.requests(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
                passes(0.5)
            self.station.stick = self.row.stick if self.station.armed else 0
            passes(0.5)
            assert self.bridge.poll() is None, self.stated
            return self.fastest > 2.0 * self.row.turns_rad_s

        awaited(turns, "it drives")
        passes(1.0)

    @property
    def stated(self) -> str:
        """Log of the bridge so far."""
        return self.log.read_text() if self.log.exists() else ""

    @property
    def samples(self) -> list[tuple[float, list[float]]]:
        """Times, and the angle of each axis then."""
        rows = [
            line.split() for line in self.truth.read_text().splitlines(keepends=True) if line.endswith("\n")
        ]
        return [(float(at), [float(one) for one in turned]) for at, *turned in rows]

    @property
    def fastest(self) -> float:
        """Present speed of the fastest axis, in rad/s."""
        return max((speed for _, speed in _speeds(self.samples[-20:])), default=0.0)

    def moved_until(self, since: float) -> float:
        """Return how many seconds after an instant the last axis came to stand; inf if one turns now."""
        speeds = list(_speeds([one for one in self.samples if one[0] >= since - WINDOW_S]))
        last = max((at for at, speed in speeds if speed > self.row.turns_rad_s), default=since)
        return float("inf") if speeds[-1][0] - last < 2 * WINDOW_S else last - since

    def chatters(self) -> None:
        """Let the line of what is emulated be dead for 1.5 s, and print without end then."""
        Path(f"{self.truth}.chatters").touch()

    def sends(self, number: signal.Signals) -> float:
        """Send the bridge a signal; return when."""
        self.bridge.send_signal(number)
        return time.monotonic()

    def ended(self, within_s: float = 40.0) -> int:
        """Return the bridge's exit status."""
        return self.bridge.wait(within_s)

    def close(self) -> None:
        """End both, whatever state they are in."""
        self.station.end()
        for process in (self.bridge, self.emulator):
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.kill()
            process.wait()


def _speeds(samples: list[tuple[float, list[float]]]) -> Iterator[tuple[float, float]]:
    """Yield when, and how fast the fastest axis turned before, over windows."""
    first = 0
    for at, turned in samples:
        while at - samples[first][0] > WINDOW_S:
            first += 1
        then, before = samples[max(first - 1, 0)]
        if at > then:
            yield at, max(abs(a - b) for a, b in zip(turned, before, strict=True)) / (at - then)


def passes(seconds: float) -> None:
    """Let real time pass, in which the processes do something."""
    threading.Event().wait(seconds)


def awaited(holds: Callable[[], bool], what: str) -> None:
    """Wait until something holds."""
    until = time.monotonic() + STARTS_WITHIN_S
    while not holds():
        assert time.monotonic() < until, what
        passes(0.05)
