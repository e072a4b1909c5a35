"""Growth of the cost with the number of drives: the whole chain on one bus, and a tick of the servo kernel.

Usage: python -m benchmarks.many_drives

The chain: a master that sends SYNC and gives each drive a speed every 50 ms, the timed bus, the drives, the
kernel, and single motors in C. The motors are those of the tests; their cost is measured alone and taken off
where a table notes it.
"""

import ctypes
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Final

from benchmarks.drives import crowd
from benchmarks.measure import fastest, interleaved, show
from emulators.servo import kernel
from emulators.servo.axis import TICK
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.unit.servo.side_by_side import PLANT, SANE, Motors, Order, Side, compiled, obey

DRIVES: Final = (1, 4, 16, 64)
TICKS: Final = {kernel.NATIVE: 100_000, kernel.REFERENCE: 4_000}
"""Number of ticks with one drive; more drives run fewer."""
SLICE: Final[Nanoseconds] = MILLISECOND
"""An advance on the bench lasts as long on average."""
MOVE, FAR_COUNTS, SPEED_RPM, RAMP_RPM_S = 2, 10**9, 2000, 3000


def chain(motors: ctypes.CDLL) -> None:
    """Print the real-time factor, and what each drive costs."""
    rows = []
    for count in DRIVES:
        whole, protocol = crowd(count, motors=motors), crowd(count)
        seconds = interleaved([whole.runs_a_second, protocol.runs_a_second])
        costs = (f"{1e3 * each / count:.2f}" for each in seconds)
        load = f"{whole.wire.load_percent():.0f} %"
        rows.append([f"{count}", f"{1.0 / seconds[0]:.1f}", *costs, load, f"{whole.turning}"])
    show(
        "The whole chain: PDOs every 50 ms at 1 Mbit/s, drives, kernel, motors",
        ("drives", "real-time factor", "ms per drive and s", "without motors", "bus load", "turning"),
        rows,
        "ms of the processor for each drive and simulated second",
    )


def advances(side: Side, ticks: int) -> Callable[[], None]:
    """Return a run over so many ticks, in advances as long as on the bench."""

    def run() -> None:
        until = side.bank.now + ticks * TICK
        while side.bank.now < until:
            side.bank.advance(min(until, side.bank.now + SLICE))

    return run


def turning(library: ctypes.CDLL, count: int, servo: kernel.KernelLibrary) -> Side:
    """Return drives on their way to a position that is far away."""
    side = Side(Motors(library, count=count), (SANE,) * count, servo)
    for axis in side.axes:
        obey(axis, Order(0, 0, 0, 0, 1000, 1000))
        obey(axis, Order(0, MOVE, FAR_COUNTS, SPEED_RPM, RAMP_RPM_S, RAMP_RPM_S))
    return side


def cost_of_a_tick(library: ctypes.CDLL, count: int, command: str) -> float:
    """Return ns per axis and tick, without the motors."""
    servo = kernel.choose(command)
    ticks = TICKS[command] // count * 4
    plant = fastest(advances(Side(Motors(library, count=count), (), servo), ticks))
    return 1e9 * (fastest(advances(turning(library, count, servo), ticks)) - plant) / (count * ticks)


def tick(motors: ctypes.CDLL) -> None:
    """Print what a tick of the regulators costs in C and in Python."""
    rows = []
    for count in DRIVES:
        native, reference = (
            cost_of_a_tick(motors, count, command) for command in (kernel.NATIVE, kernel.REFERENCE)
        )
        rows.append([f"{count}", f"{native:.1f}", f"{reference:.0f}", f"{reference / native:.0f}"])
    show(
        "The regulators alone, 10 kHz, motors taken off: ns per axis and tick",
        ("drives", "kernel", "reference", "times"),
        rows,
    )


def main() -> int:
    """Print both."""
    with tempfile.TemporaryDirectory() as folder:
        motors = ctypes.CDLL(str(compiled(Path(folder), PLANT, "-O2")))
        chain(motors)
        tick(motors)
    return 0


if __name__ == "__main__":
    sys.exit(main())
