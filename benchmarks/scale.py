"""Growth with the number of drives, of buses and of robots: time, and memory.

The drives are those of `benchmarks.drives`: a master of each bus sends SYNC and gives each drive a speed
every 50 ms, the buses keep their times, motors in C turn; all is in one world. Robots are four RARS, each
with bus, bridge and operator of its own, taken on in turns by one clock.
"""

import ctypes
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from benchmarks.drives import crowd, only_sync
from benchmarks.figure import Figure
from benchmarks.measure import KIB_A_MIB, interleaved
from benchmarks.reference import loop_ms
from benchmarks.watches import rig_and_operator
from emulators.rig import Rig
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.servo.side_by_side import PLANT, compiled

DRIVES: Final = (1, 4, 16, 64)
FULL_BUS: Final = 127
FULL_EVERY: Final[Nanoseconds] = 100 * MILLISECOND
"""Period of SYNC and of the heartbeats there: more does not go on a bus of 1 Mbit/s."""
BUSES: Final = 8
ROBOTS: Final = 4
DRIVEN_S: Final = 8
SLICE: Final[Nanoseconds] = 10 * MILLISECOND
"""Step of the clock of several robots: what one has in the processor's cache the next one takes out of it."""
LARGEST_MORE: Final = 0.1
MEMORY: Final = f"""
from benchmarks.measure import resident_kib
from benchmarks.watches import rig_and_operator
from firmware_bridge.units import SECOND
rigs = []
def added():
    rigs.append(rig_and_operator()[0])
    rigs[-1].run({DRIVEN_S} * SECOND)
added()
first = resident_kib()
for _ in range({ROBOTS}):
    added()
print(first, resident_kib() - first)
"""
GROWTH: Final = 1.25
"""What a drive, a bus or a robot may cost among many, against one alone."""


def figures() -> Iterator[Figure]:
    """Measure drives, buses, robots and memory."""
    with tempfile.TemporaryDirectory() as folder:
        motors = ctypes.CDLL(str(compiled(Path(folder), PLANT, "-O2")))
        yield from _drives(motors)
        yield from _buses(motors)
    yield from _robots()


def _drives(motors: ctypes.CDLL) -> Iterator[Figure]:
    crowds = [crowd(count, motors=motors) for count in DRIVES]
    crowds.append(
        crowd(
            FULL_BUS,
            motors=motors,
            every=FULL_EVERY,
            heartbeat_ms=FULL_EVERY // MILLISECOND,
            cycle=only_sync,
        )
    )
    each = [1e3 * taken for taken in interleaved([one.runs_a_second for one in crowds])]
    loop = loop_ms()
    yield Figure(name="1 drive", value=each[0], unit="ms/s", against="loop, ms", reference=loop)
    for count, taken in zip(DRIVES[1:], each[1:], strict=False):
        yield Figure(
            name=f"{count} drives, each",
            value=taken / count,
            unit="ms/s",
            against="1 drive",
            reference=each[0],
            goal=GROWTH,
        )
    yield Figure(
        name=f"{FULL_BUS} drives on one bus, SYNC each 100 ms",
        value=each[-1],
        unit="ms/s",
        against="real time",
        reference=1e3,
        goal=1.0,
    )


def _buses(motors: ctypes.CDLL) -> Iterator[Figure]:
    one, many = crowd(DRIVES[1], motors=motors), crowd(DRIVES[1], motors=motors, buses=BUSES)
    alone, together = interleaved([one.runs_a_second, many.runs_a_second])
    yield Figure(
        name=f"{BUSES} buses of {DRIVES[1]} drives, each",
        value=1e3 * together / BUSES,
        unit="ms/s",
        against="1 bus",
        reference=1e3 * alone,
        goal=GROWTH,
    )


def _robots() -> Iterator[Figure]:
    rigs: list[Rig] = [rig_and_operator()[0] for _ in range(1 + ROBOTS)]
    until = DRIVEN_S * SECOND

    def driven(several: list[Rig]) -> None:
        for at in range(0, until + 1, SLICE):
            for one in several:
                one.run(at)

    alone, together = interleaved([lambda: driven(rigs[:1]), lambda: driven(rigs[1:])], 1)
    for one in rigs:
        one.finish()
    yield Figure(
        name=f"{ROBOTS} RARS in one process, each",
        value=1e3 * together / ROBOTS / DRIVEN_S,
        unit="ms/s",
        against="1 RARS",
        reference=1e3 * alone / DRIVEN_S,
        goal=GROWTH,
    )
    # In a process of its own: what another benchmark has let go of would be taken again.
    printed = subprocess.run([sys.executable, "-P", "-c", MEMORY], capture_output=True, text=True, check=True)  # noqa: S603 - ours
    first, more = map(float, printed.stdout.split())
    yield Figure(
        name="memory of one more RARS on its bench",
        value=more / ROBOTS / KIB_A_MIB,
        unit="MiB",
        against="a process with one",
        reference=first / KIB_A_MIB,
        goal=LARGEST_MORE,
    )
