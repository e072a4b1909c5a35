"""Check of a long run's memory: the mission `circles`, recorded to files, looked at each minute.

Usage: python -m benchmarks.memory [MINUTES] [--live]    simulated time; 5 by default, `make hour` drives 60.

With --live it runs behind the live page, one page open, which watches the frames, for 6 minutes or more.

Some things grow by design, because the pictures and the summary at a run's end are made of them: a sample
every 10 ms, the operator's diary, the holds. Samples and diary are freed at each minute's end, and listed
apart; what is left must not grow. Frames and messages go to files as they come. Caches with a bound are
emptied before each look, since a mission may take many minutes to fill them; one without a bound counts.
"""

import argparse
import gc
import sys
import tempfile
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Protocol

from benchmarks.figure import Figure
from benchmarks.measure import resident_kib, show
from benchmarks.watches import rig_and_operator
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import find as mission_of
from emulators.bench.operator import ScriptedOperator
from emulators.control.desk import Desk
from emulators.control.live import Live
from emulators.live.bench import LiveBench
from emulators.paced import PacedRig
from emulators.recorded import recorded
from emulators.rig import Rig
from emulators.run import RunOrder
from firmware_bridge.live.messages import LIVE, OPENED
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds, from_seconds

MINUTES: Final = 5
MINUTE_S: Final = 60.0
WARM_UP: Final = 3
"""Minutes until every service has been received once."""
PAGE_FILLS: Final = 5
"""The same with a page, until its moments of two minutes and its lists are full."""
LARGEST_GROWTH: Final = 4_096
"""Limit for the growth of the rest, in bytes per minute.

A list that takes one number a bridge cycle grows by 48,000. The interpreter's own free lists, which are
bounded, still fill by some 1,500.
"""
LARGEST_RESIDENT: Final = 1.05
WOKEN_EVERY: Final[Nanoseconds] = 10 * MILLISECOND
MEASURED: Final = ("emulators", "firmware_bridge", "fmu")
KIB: Final = 1024


@dataclass(frozen=True, slots=True)
class Mark:
    """The memory at the end of one minute, in bytes but for the resident KiB."""

    samples: int
    diary: int
    left: int
    resident: int


class Clearable(Protocol):
    """A list, or a table of samples."""

    def clear(self) -> None:
        """Forget all rows."""


def let_go(rows: Clearable) -> int:
    """Forget some rows; return the bytes that they held."""
    before, _ = tracemalloc.get_traced_memory()
    rows.clear()
    return before - tracemalloc.get_traced_memory()[0]


def bounded_caches() -> Iterator[Any]:
    """Give the caches with a bound, of all the modules of the program that have been imported."""
    for name, module in sys.modules.items():
        if name.partition(".")[0] in MEASURED:
            for thing in vars(module).values():
                if hasattr(thing, "cache_clear") and thing.cache_info().maxsize is not None:
                    yield thing


def look(rig: Rig, operator: ScriptedOperator) -> Mark:
    """Let go of what grows by design or to a bound, and measure the former and the rest."""
    for cache in bounded_caches():
        cache.cache_clear()
    gc.collect()
    samples = let_go(rig.samples)
    diary = let_go(operator.diary.odometry) + let_go(operator.diary.entries)
    left, _ = tracemalloc.get_traced_memory()
    return Mark(samples, diary, left, resident_kib())


def behind_a_page(rig: Rig) -> Callable[[Nanoseconds], None]:
    """Return what runs a rig up to an instant behind the live page, at the clock's pace."""
    setup = bench_setup_of(rig.robot)
    script = mission_of("circles", rig.robot, setup)
    order = RunOrder(rig.robot, setup, "circles", script, 0, Path())
    live = Live(rig.robot, rig.devices, rig.world, rig.devices.plant, rig.faults, in_reach=True)
    paced = PacedRig(rig, NEVER)
    page = LiveBench(rig, paced, Desk(paced, live, lambda _: None), order)
    page.receive(Packet(LIVE, 1, OPENED), 0)
    page.receive(Packet(LIVE, 1, b'{"id":1,"do":"watch_frames","on":true}'), 0)
    woken = 0

    def run(until: Nanoseconds) -> None:
        nonlocal woken
        while woken < until:
            woken += WOKEN_EVERY
            page.wake(woken)

    return run


def drive(minutes: int, *, live: bool) -> list[Mark]:
    """Drive so many minutes; return what was seen at the end of each."""
    rig, operator = rig_and_operator()
    run = behind_a_page(rig) if live else rig.run
    marks = []
    tracemalloc.start()
    with tempfile.TemporaryDirectory() as folder, recorded(rig, Path(folder)):
        for minute in range(1, minutes + 1):
            run(from_seconds(minute * MINUTE_S))
            marks.append(look(rig, operator))
    tracemalloc.stop()
    rig.finish()
    return marks


def shown(marks: list[Mark]) -> list[int]:
    """Return the minutes that are printed: the first ones, then every tenth, and the last."""
    return [n for n in range(1, len(marks) + 1) if n <= MINUTES or n % 10 == 0 or n == len(marks)]


def grown(marks: list[Mark], warm_up: int) -> tuple[float, float]:
    """Return growth after the warm-up: of the rest in bytes a minute, of the resident memory as a ratio."""
    first, last = marks[warm_up - 1], marks[-1]
    return (last.left - first.left) / (len(marks) - warm_up), last.resident / first.resident


def figures() -> Iterator[Figure]:
    """Watch some minutes."""
    left, resident = grown(drive(MINUTES, live=False), WARM_UP)
    yield Figure(
        name="RARS, circles: memory grows a minute",
        value=left,
        unit="B",
        against="what is let pass",
        reference=LARGEST_GROWTH,
        goal=1.0,
    )
    yield Figure(
        name="RARS, circles: resident memory",
        value=resident,
        unit="",
        against=f"after {WARM_UP} minutes",
        reference=1.0,
        goal=LARGEST_RESIDENT,
    )


def main(minutes: int, *, live: bool) -> int:
    """Print the memory; 1 where it grows."""
    warm_up = PAGE_FILLS if live else WARM_UP
    if minutes <= warm_up:
        print(f"at least {warm_up + 1} minutes, not {minutes}", file=sys.stderr)
        return 2
    marks = drive(minutes, live=live)
    show(
        f"circles{' with a page' if live else ''}, {minutes} simulated minutes: memory at a minute's end",
        ("minute", "resident MiB", "left KiB", "samples KiB", "diary KiB"),
        [
            [
                f"{minute}",
                f"{mark.resident / KIB:.1f}",
                *(f"{size / KIB:,.0f}" for size in (mark.left, mark.samples, mark.diary)),
            ]
            for minute in shown(marks)
            for mark in (marks[minute - 1],)
        ],
    )
    last, (growth, resident) = marks[-1], grown(marks, warm_up)
    hour = (last.samples + last.diary) * MINUTE_S / KIB**2
    print(f"by design: samples and diary, {hour:.0f} MiB in an hour, until the run's pictures are drawn")
    print(f"the rest: {growth:+,.0f} bytes a minute after minute {warm_up}")
    if growth > LARGEST_GROWTH or resident > LARGEST_RESIDENT:
        print("a long run does not keep its memory", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    words = argparse.ArgumentParser(prog="memory", description=__doc__)
    words.add_argument("minutes", nargs="?", type=int, default=MINUTES)
    words.add_argument("--live", action="store_true")
    given = words.parse_args()
    sys.exit(main(given.minutes, live=given.live))
