"""Result of `fmea` on each shipped robot: for each interlock its cells and the worst of them.

A cell is one failure at one place in one state of the robot. The worst of several is the one that deviates
most from the run without the failure. `tools/measure_fmea.py` runs it and writes `analyzed.csv`.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from emulators.bench.faults.failures import Failure
from emulators.fmea.effect import Assessment
from emulators.fmea.matrix import Cell, all_failures, matrix, of_state, state_names
from firmware_bridge.robot_types import find
from hil_tests.failures.kept import Kept


@dataclass(frozen=True, slots=True)
class Analyzed:
    """Cells of a robot that one interlock noticed first in time, or those of a kind that none did."""

    robot: str
    noticed_by: str
    """Name of the interlock, without link and axis; empty: none in time, for a known reason."""
    cells: int
    latest_ms: int | None
    """Longest time until it was noticed."""
    state: str
    """State, kind, title and place of the worst cell."""
    kind: str
    failure: str
    place: str
    after_ms: int | None
    standstill_ms: int | None
    """None where it still moves at the end."""
    goes_mm: int
    turns_deg: int
    why: str
    """Reason why these cells need not be noticed in time; empty where an interlock noticed them."""


KEPT: Final = Kept(Analyzed, "analyzed", Path(__file__).parent)


def analyzed(robot: str, jobs: int) -> list[Analyzed]:
    """Run the whole matrix of a robot, and return a row for each interlock that noticed a failure."""
    whole = find(robot)
    cells = matrix(partial(find, robot), state_names(whole), all_failures(whole), jobs, lambda _: None)
    return list(_rows(robot, cells))


def again(row: Analyzed) -> Analyzed:
    """Run the worst cell of a row again; return the row with what was found."""
    failures = [one for one in all_failures(find(row.robot)) if _is_of(one, row)]
    (cell,) = of_state(partial(find, row.robot), failures, row.state)
    found = _row(row.robot, _interlock(cell), [cell])
    return Analyzed(**{name: getattr(found, name) for name in found.__slots__} | _counts(row))


def _counts(row: Analyzed) -> dict[str, int | None]:
    return {"cells": row.cells, "latest_ms": row.latest_ms}


def _is_of(failure: Failure, row: Analyzed) -> bool:
    return (failure.kind, failure.title, failure.place) == (row.kind, row.failure, row.place)


def _rows(robot: str, cells: Sequence[Cell]) -> Iterator[Analyzed]:
    found: dict[tuple[str, str], list[Cell]] = {}
    for cell in cells:
        if cell.late:
            found.setdefault(("", cell.failure.kind), []).append(cell)
        elif cell.effect.verdict is Assessment.NOTICED:
            found.setdefault((_interlock(cell), ""), []).append(cell)
    for name, kind in sorted(found):
        yield _row(robot, name, found[name, kind])


def _interlock(cell: Cell) -> str:
    return "" if cell.late else cell.effect.noticed_by.split(":")[0]


def _row(robot: str, name: str, cells: Sequence[Cell]) -> Analyzed:
    worst = max(cells, key=lambda cell: (cell.effect.standstill_after_ms is None, cell.effect.aside))
    times = [cell.effect.after_ms for cell in cells if cell.effect.after_ms is not None]
    effect = worst.effect
    return Analyzed(
        robot,
        name,
        len(cells),
        round(max(times)) if times else None,
        worst.state,
        worst.failure.kind,
        worst.failure.title,
        worst.failure.place,
        None if effect.after_ms is None else round(effect.after_ms),
        None if effect.standstill_after_ms is None else round(effect.standstill_after_ms),
        round(1000 * effect.goes_m),
        round(math.degrees(effect.turns_rad)),
        worst.why if worst.late else "",
    )
