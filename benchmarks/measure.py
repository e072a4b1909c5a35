"""Common parts of the benchmarks: the processor's shortest time of some runs, memory, and tables."""

import resource
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Final

from rich import box
from rich.console import Console
from rich.table import Table

REPEATS: Final = 3
WIDTH: Final = 140
KIB_A_MIB: Final = 1024


def processor_seconds(run: Callable[[], object]) -> float:
    """Return the processor's time for one run, in all threads of this process."""
    begun = time.process_time()
    run()
    return time.process_time() - begun


def both_clocks(run: Callable[[], object]) -> tuple[float, float]:
    """Return the time of one run in seconds: the processor's, and the wall's."""
    begun = time.perf_counter()
    spent = processor_seconds(run)
    return spent, time.perf_counter() - begun


def fastest(run: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the processor's shortest time of some runs in seconds: what others do meanwhile counts least."""
    return min(processor_seconds(run) for _ in range(repeats))


def interleaved(runs: Sequence[Callable[[], object]], repeats: int = REPEATS) -> list[float]:
    """Return the shortest time of each, taken in turns, so that a ratio compares the same minute."""
    times = [[processor_seconds(run) for run in runs] for _ in range(repeats)]
    return [min(column) for column in zip(*times, strict=True)]


def resident_kib() -> int:
    """Return the memory of this process in KiB; its largest so far where the system has no other."""
    status = Path("/proc/self/status")
    if status.exists():
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmRSS"))
        return int(line.split()[1])
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def show(title: str, head: Sequence[str], rows: Iterable[Sequence[str]], note: str = "") -> None:
    """Print a table: names to the left, figures to the right."""
    table = Table(box=box.SIMPLE_HEAD)
    for place, name in enumerate(head):
        table.add_column(name, justify="right" if place else "left")
    for row in rows:
        table.add_row(*row)
    console = Console(width=WIDTH, highlight=False)
    console.print(title, style="bold")
    console.print(table)
    if note:
        console.print(f"{note}\n")
