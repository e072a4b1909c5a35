"""Emulated drives in a thread of this process, on a pseudo-terminal and a virtual CAN bus, in real time."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from typing import Final

from typer.testing import CliRunner

from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.single import DrivesOrder, drives
from emulators.gateway import Cluster
from firmware_bridge.cli import program
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.node import CAN, SERIAL, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import PseudoTerminal, open_can
from firmware_bridge.runtime.runner import run
from firmware_bridge.units import MILLISECOND, Nanoseconds

NUMBERS: Final = count()
STARTED: Final[Nanoseconds] = 10 * MILLISECOND
"""Time for the drives' start, which a busy machine may put behind the first request."""
NEAR: Final = 1
FAR: Final = 2


@dataclass(frozen=True)
class Reported:
    """Output and exit status of a command."""

    status: int
    out: str
    err: str

    @property
    def line(self) -> str:
        """The one line of a refusal."""
        (line,) = self.err.splitlines()
        assert line.startswith("firmware-bridge: ")
        return line


def ask(*words: str) -> Reported:
    """Run a command in this process."""
    result = CliRunner().invoke(program, ["epos2", *words])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert "Traceback" not in result.output
    return Reported(result.exit_code, result.stdout, result.stderr)


class UntilReported:
    """A node that goes on until someone has had enough."""

    def __init__(self, node: Node) -> None:
        self.finished = False
        self.started = threading.Event()
        self._node = node

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        return self._node.receive(packet, now)

    def wake(self, now: Nanoseconds) -> Reaction:
        if now >= STARTED:
            self.started.set()
        return self._node.wake(now)


@dataclass(frozen=True)
class Bench:
    """Links to the drives."""

    generation: Generation
    path: str
    channel: str

    @property
    def serial(self) -> tuple[str, ...]:
        return ("--serial", self.path, "--protocol", self.generation.value)

    @property
    def can(self) -> tuple[str, ...]:
        return ("-i", "virtual", "-c", self.channel)


@contextmanager
def bench(generation: Generation = Generation.V1) -> Iterator[Bench]:
    """Run two drives, the first one on the line, until the end of the block."""
    made, bank = drives(DrivesOrder((NEAR, FAR), PROFILES["70/10"], 1_000_000, serial={NEAR: generation}))
    node = UntilReported(Cluster(made, bank, links={"motor1": {CAN: CAN, SERIAL: SERIAL}}))
    terminal, channel = PseudoTerminal(), f"bench-drives-{next(NUMBERS)}"
    ports = {SERIAL: terminal, CAN: open_can("virtual", channel)}
    thread = threading.Thread(target=run, args=(node, ports, Clock()), name=channel)
    thread.start()
    node.started.wait()
    try:
        yield Bench(generation, terminal.path, channel)
    finally:
        node.finished = True
        thread.join()
