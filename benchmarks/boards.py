"""Speed of an emulated Arduino board against real time, and a test of eight at once on this machine.

A board of each firmware turns three motors, with a host that sends something every 50 ms. Times are the
processor's. Then eight boards turn their motors in real time, each a process of its own on a
pseudo-terminal, and receive a request in every cycle.
"""

import resource
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Final

import serial

from benchmarks.figure import Figure
from benchmarks.measure import interleaved
from emulators.arduino_omni.board import FIRMWARES, Board
from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.motors import four_motors
from emulators.arduino_omni.shield.motor_shield import PORTS
from firmware_bridge.families.motor_shield.wire import mw, mw_messages
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, from_seconds, to_seconds

READY: Final[Nanoseconds] = 4 * SECOND
CYCLE: Final[Nanoseconds] = 50 * MILLISECOND
TURNED: Final = 10.0
"""rad, at least, of each motor that turns."""
MOTORS: Final = 3
BOARDS: Final = 8
REAL_S: Final = 10
BAUD: Final = 57_600
LATEST: Final = 1
"""Cycles that an answer may take more than its own."""
SIMULATED_S: Final = 10.0
LARGEST_SHARE: Final = 1.0 / 3.0


def _register_writes() -> tuple[bytes, ...]:
    """Return Firmata's messages that set three motors going."""
    writes = [bytes((0, 0x21))]
    for port in PORTS[:MOTORS]:
        writes += [library.set_speed(port, 150), *library.run(port, library.RunArgument.FORWARD)]
    pairs = [bytes(half for byte in data for half in (byte & 0x7F, byte >> 7)) for data in writes]
    return (bytes((0xF0, 0x78, 0, 0, 0xF7)), *(b"\xf0\x76\x60\x00" + it + b"\xf7" for it in pairs))


def _requests() -> tuple[bytes, ...]:
    """Return MWProtocol's messages that do so."""
    wanted: list[mw.Message] = [mw_messages.CreateShield(0, 0x60, library.DEFAULT_HZ)]
    for motor in range(MOTORS):
        wanted += [mw_messages.CreateMotor(0, motor), mw_messages.StartMotor(0, motor, 150, 1)]
    return tuple(mw.encode_request(it, 0) for it in wanted)


HOSTS: Final[Mapping[str, tuple[tuple[bytes, ...], bytes]]] = MappingProxyType(
    {
        "mw": (_requests(), mw.encode_request(mw_messages.SetMotorSpeed(0, 0, 140, 1), 0)),
        "ros-arduino-bridge": ((b"m 40 -40 20\r",), b"e\r"),
        "arduinoio": ((b"A1\x96B1f", b"A2\x96B2f", b"A3\x96B3f"), b"99"),
        "firmata": (_register_writes(), bytes((0xF0, 0x76, 0x60, 0x08, 0, 0, 1, 0, 0xF7))),
    }
)
"""Packets by firmware: those that turn the motors, and that of each cycle then."""


def drive(firmware: str, simulated: Nanoseconds) -> None:
    """Run one board; RuntimeError where its motors stand."""
    board = Board(FIRMWARES[firmware], four_motors(), auto_stop=30_000)
    first, always = HOSTS[firmware]
    stated = list(reversed(first))
    now = wake_at = states_at = 0
    while now < READY + simulated:
        at = min(wake_at, READY + states_at)
        now = max(now, at)
        if READY + states_at <= now:
            states_at += CYCLE
            chunk = stated.pop() if stated else always
            wake_at = board.receive(Packet(SERIAL, 0, chunk), now).wake_at
        else:
            wake_at = board.wake(now).wake_at
    if min(abs(angle) for angle in board.motors.angles[:MOTORS]) < TURNED:
        raise RuntimeError(f"a motor of the board with {firmware} did not turn")


def in_real_time() -> tuple[int, float]:
    """Run boards as processes of their own, and ask each in every cycle.

    Return how many cycles an answer was late at worst, and the processor's seconds a board and a second.
    """
    program = str(Path(sys.executable).with_name("firmware-bridge"))
    words = [program, "emulate", "board", "--firmware", "ros-arduino-bridge"]
    with TemporaryDirectory() as folder, ExitStack() as opened:
        links = [Path(folder, f"board{number}") for number in range(BOARDS)]
        running = [
            subprocess.Popen([*words, "--serial-link", it], stdout=subprocess.PIPE, text=True)  # noqa: S603 - ours
            for it in links
        ]
        for board in running:
            assert board.stdout is not None  # noqa: S101 - for the type checker: it is a pipe
            board.stdout.readline()  # the pseudo-terminal is there
        hosts = [opened.enter_context(serial.Serial(str(it), BAUD, timeout=0)) for it in links]
        clock, worst = Clock(), 0
        clock.wait([], READY)
        waiting = [0] * BOARDS
        for cycle in range(REAL_S * SECOND // CYCLE):
            for number, host in enumerate(hosts):
                host.write(b"m 40 -40 20\r")
                waiting[number] += 1
            clock.wait([], READY + (cycle + 1) * CYCLE)
            for number, host in enumerate(hosts):
                waiting[number] -= host.read(host.in_waiting).count(b"OK")
            worst = max(worst, *waiting)
        for board in running:
            board.terminate()
            board.wait()
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = used.ru_utime + used.ru_stime
    return worst, spent / BOARDS / (to_seconds(READY) + REAL_S)


def figures() -> Iterator[Figure]:
    """Measure a board of each firmware, and eight in real time."""
    names = list(HOSTS)
    runs = [lambda name=name: drive(name, from_seconds(SIMULATED_S)) for name in names]  # type: ignore[misc] # bound now
    times = interleaved(runs)
    for name, taken in zip(names, times, strict=True):
        yield Figure(
            name=f"board, {FIRMWARES[name].title}",
            value=1e3 * taken / SIMULATED_S,
            unit="ms/s",
            against="real time",
            reference=1e3,
            goal=LARGEST_SHARE,
        )
    late, share = in_real_time()
    yield Figure(
        name=f"{BOARDS} boards in real time, latest answer",
        value=late + 1,
        unit="cycles",
        against="its own",
        reference=1,
        goal=LATEST + 1,
    )
    yield Figure(
        name=f"{BOARDS} boards in real time, each",
        value=100 * share,
        unit="%",
        against="a core",
        reference=100,
    )
