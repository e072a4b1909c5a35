"""The worst cells of a matrix: what still moves first, then by the deviation from the run without it."""

from emulators.bench.faults.failures import Failure
from emulators.fmea.effect import Assessment, Effect
from emulators.fmea.matrix import Cell
from emulators.fmea.report import WORST, worst


def cell(state: str, aside: float, still_ms: float | None, place: str = "") -> Cell:
    effect = Effect(Assessment.NOTICED, "axis timeout", 250.0, still_ms, 0.1, 0.5, aside)
    return Cell(state, Failure("can_cut", place, {}, lasts=True), effect)


def test_what_still_moves_is_the_worst_and_then_what_deviates_most() -> None:
    cells = [cell("a", 3.0, 700.0), cell("b", 0.5, None, "left"), cell("c", 9.0, 800.0), cell("d", 1.0, 10.0)]
    rows = [dict(zip(WORST, row, strict=True)) for row in worst(cells)]
    assert [row["state"] for row in rows] == ["b", "c", "a"]
    assert rows[0] == {
        "state": "b",
        "deviation": "0.5",
        "moved": "100 mm, 29°",
        "noticed by": "axis timeout",
        "after": "250 ms",
        "standstill": "keeps moving",
        "failure": "can_cut (left)",
    }
    assert (rows[1]["standstill"], rows[1]["failure"]) == ("800 ms", "can_cut")


def test_of_few_cells_all_are_shown() -> None:
    assert len(worst([cell("a", 0.0, 0.0)])) == 1
    assert worst([]) == []
