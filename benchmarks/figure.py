"""Figures of `make bench`: each a value beside its reference of the same run, and the goal of their ratio."""

import csv
import os
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from benchmarks.measure import show

MOST_OTHERS: Final = 0.3
"""Processors that others may keep busy meanwhile; above it no figure counts."""
HISTORY: Final = Path(__file__).with_name("history.csv")
"""Ratios by release: a row for each figure of each release."""
COLUMNS: Final = ("release", "day", "figure", "ratio")
_STAT: Final = Path("/proc/stat")
_IDLE: Final = (3, 4)
"""Columns of /proc/stat in which a processor does nothing (proc(5)): idle, iowait."""
_COUNTED: Final = 8
"""Its columns up to steal; a guest's time is counted in the first two."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A measured value; value and reference have the same unit."""

    name: str
    value: float
    unit: str
    against: str
    """Name of the reference."""
    reference: float
    goal: float | None = None
    """Limit of the ratio; None for a figure that is only watched."""
    at_least: bool = False
    """True where the goal is the least ratio, not the largest."""

    @property
    def ratio(self) -> float:
        """Value by reference."""
        return self.value / self.reference

    @property
    def met(self) -> bool:
        """Return whether the goal is met; always without one."""
        if self.goal is None:
            return True
        return self.ratio >= self.goal if self.at_least else self.ratio <= self.goal

    @property
    def limit(self) -> str:
        """The goal as text."""
        return "" if self.goal is None else f"{'>=' if self.at_least else '<='} {self.goal:.3g}"


class OthersLoad:
    """Load of this machine by other processes since it was made."""

    def __init__(self) -> None:
        self._began = time.perf_counter()
        self._busy, self._own = _busy_s(), _own_s()

    def seen(self) -> float:
        """Return how many processors others kept busy, on average, or what the system calls its load."""
        elapsed = time.perf_counter() - self._began
        if not _STAT.exists():
            return max(os.getloadavg()[0] - (_own_s() - self._own) / elapsed, 0.0)
        return max((_busy_s() - self._busy) - (_own_s() - self._own), 0.0) / elapsed


def _busy_s() -> float:
    """Return the seconds in which the processors have worked, of all together."""
    if not _STAT.exists():
        return 0.0
    ticks = [int(one) for one in _STAT.read_text().split("\n", 1)[0].split()[1 : 1 + _COUNTED]]
    return (sum(ticks) - sum(ticks[place] for place in _IDLE)) / os.sysconf("SC_CLK_TCK")


def _own_s() -> float:
    """Return the processor's seconds of this process and of its children that have ended."""
    return sum(os.times()[:4])


def ratios(release: str | None = None) -> dict[str, float]:
    """Return the ratios of a release by the figures' names; of the newest one without a name."""
    rows = list(_history())
    wanted = release or (rows[-1]["release"] if rows else "")
    return {row["figure"]: float(row["ratio"]) for row in rows if row["release"] == wanted}


def keep(figures: Iterable[Figure], release: str) -> None:
    """Write the ratios of a release into the history, in place of what it had of that release."""
    rows = [row for row in _history() if row["release"] != release]
    day = time.strftime("%Y-%m-%d")
    rows += [
        {"release": release, "day": day, "figure": one.name, "ratio": f"{one.ratio:.3g}"} for one in figures
    ]
    with HISTORY.open("w", newline="", encoding="utf-8") as file:
        written = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        written.writeheader()
        written.writerows(rows)


def _history() -> Iterator[dict[str, str]]:
    if HISTORY.exists():
        with HISTORY.open(newline="", encoding="utf-8") as file:
            yield from csv.DictReader(file)


def table(figures: Iterable[Figure], title: str, note: str) -> None:
    """Print the figures, with the ratios of the release before."""
    before = ratios()
    rows = [
        (
            one.name,
            f"{one.value:.3g} {one.unit}",
            f"{one.against}, {one.reference:.3g}",
            f"{one.ratio:.3g}",
            one.limit,
            "" if one.met else "missed",
            f"{before[one.name]:.3g}" if one.name in before else "",
        )
        for one in figures
    ]
    show(title, ("figure", "value", "reference", "ratio", "goal", "", "last release"), rows, note)
