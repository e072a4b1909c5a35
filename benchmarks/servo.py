"""What a tick costs: kernel and twin for 1 to 64 drives, and whether a long run keeps its memory.

Usage: python -m benchmarks.servo [MINUTES]    simulated time of the run whose memory is watched, else 60.

The plant here is that of the tests, motors in C; its cost is measured alone and taken off.
"""

import ctypes
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

from benchmarks.realtime import rig_and_operator
from emulators.servo import kernel
from emulators.servo.axis import TICK
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from hil_tests.unit.servo.side_by_side import PLANT, SANE, Motors, Order, Side, compiled, obey

DRIVES: Final = (1, 4, 16, 64)
TICKS: Final = {"kernel": 100_000, "twin": 4_000}
REPEATS: Final = 3
SLICE: Final = MILLISECOND
"""An advance on the bench lasts as long on average."""
LARGEST_GROWTH: Final = 1.05
MINUTE_S: Final = 60.0


def seconds(side: Side, ticks: int, cut: Nanoseconds) -> float:
    """Return the processor's shortest time for so many ticks, in advances of this length."""
    times = []
    for _ in range(REPEATS):
        until = side.bank.now + ticks * TICK
        begun = time.process_time()
        while side.bank.now < until:
            side.bank.advance(min(until, side.bank.now + cut))
        times.append(time.process_time() - begun)
    return min(times)


def turning(library: ctypes.CDLL, count: int, servo: kernel.Found) -> Side:
    """Return drives on their way to a position that is far away."""
    side = Side(Motors(library, count=count), (SANE,) * count, servo)
    for axis in side.axes:
        obey(axis, Order(0, 0, 0, 0, 1000, 1000))
        obey(axis, Order(0, 2, 10**9, 2000, 3000, 3000))
    return side


def per_tick(library: ctypes.CDLL) -> None:
    """Print nanoseconds per axis and tick, and how many times longer the twin takes."""
    servos = {"kernel": kernel.choose(kernel.NATIVE), "twin": kernel.choose(kernel.TWIN)}
    print(f"{'drives':>8s}{'kernel':>12s}{'twin':>12s}{'ratio':>10s}   ns per axis and tick")
    for count in DRIVES:
        cost = {}
        for name, servo in servos.items():
            ticks = TICKS[name] // count * 4
            alone = Side(Motors(library, count=count), (), servo)
            plant = seconds(alone, ticks, SLICE)
            cost[name] = (
                1e9 * (seconds(turning(library, count, servo), ticks, SLICE) - plant) / (count * ticks)
            )
        print(f"{count:8d}{cost['kernel']:12.1f}{cost['twin']:12.0f}{cost['twin'] / cost['kernel']:10.0f}")


def resident_kib() -> int:
    """Return the memory of this process in KiB; its largest so far where the system tells no other."""
    status = Path("/proc/self/status")
    if status.exists():
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmRSS"))
        return int(line.split()[1])
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def memory(minutes: float) -> bool:
    """Drive for long, with all records of the run thrown away; print the memory, and whether it stays."""
    one, operator = rig_and_operator()
    held = []
    for tenth in range(1, 11):
        one.run(from_seconds(tenth * minutes * MINUTE_S / 10))
        one.samples.clear()
        operator.diary.odometry.clear()
        operator.diary.entries.clear()
        held.append(resident_kib())
    one.finish()
    growth = held[-1] / held[1]
    print(f"memory over {minutes:g} simulated minutes: {held[1]} KiB after 20 %, {held[-1]} KiB at the end")
    return growth <= LARGEST_GROWTH


def main(minutes: float) -> int:
    """Print both; fail where memory grows."""
    with tempfile.TemporaryDirectory() as folder:
        per_tick(ctypes.CDLL(str(compiled(Path(folder), PLANT, "-O2"))))
    if not memory(minutes):
        print("a long run does not keep its memory", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0))
