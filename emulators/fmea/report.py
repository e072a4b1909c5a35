"""The matrix as tables: lines of CSV, and one page of HTML."""

import csv
import html
import io
from collections.abc import Iterator, Sequence
from typing import Final

from emulators.bench.web import document
from emulators.fmea.effect import Assessment
from emulators.fmea.matrix import Cell

COLUMNS: Final = (
    *("state", "failure", "place", "verdict", "noticed_by", "after_ms", "standstill_after_ms", "goes_mm"),
    *("turns_deg", "aside", "why"),
)
DEGREES: Final = 57.29577951308232
LOOK: Final = """
body { max-width: none; margin: 2em } th, td { border: 1px solid #ddd; padding: .2em .5em }
thead th { position: sticky; top: 0; background: #fff }
.noticed { background: #e3f1ea } .reported { background: #e4eef8 }
.tolerated { background: #fff; color: #888 } .stopped { background: #f3f3e2 } .why { background: #fbeccb }
.wrong { background: #f6c6bd; font-weight: bold }
small { color: #666; display: block }
"""
LEGEND: Final = (
    (Assessment.NOTICED, "an interlock is active: which, and after how long"),
    (Assessment.REPORTED, "the operator was informed, and no interlock is active"),
    (Assessment.TOLERATED, "the robot moves as without the failure"),
    (Assessment.STOPPED, "nothing was reported, and the robot came to standstill"),
)


WORST: Final = ("state", "deviation", "moved", "noticed by", "after", "standstill", "failure")


def worst(cells: Sequence[Cell], count: int = 3) -> list[tuple[str, ...]]:
    """Return the cells that deviate most from the run without the failure, as `WORST` names their texts.

    The deviation is a share of its limit; one that still moves at the end is worse than any that does not.
    """

    def badness(cell: Cell) -> tuple[bool, float, str, str]:
        still = cell.effect.standstill_after_ms is not None
        return still, -cell.effect.aside, cell.state, cell.failure.title

    rows: list[tuple[str, ...]] = []
    for cell in sorted(cells, key=badness)[:count]:
        found, stops = cell.effect, cell.effect.standstill_after_ms
        place = f" ({cell.failure.place})" if cell.failure.place else ""
        rows.append(
            (
                *(cell.state, f"{found.aside:.1f}"),
                f"{1e3 * found.goes_m:.0f} mm, {DEGREES * found.turns_rad:.0f}°",
                found.noticed_by or "-",
                "-" if found.after_ms is None else f"{found.after_ms:.0f} ms",
                "keeps moving" if stops is None else f"{stops:.0f} ms",
                f"{cell.failure.title}{place}",
            )
        )
    return rows


def as_csv(cells: Sequence[Cell]) -> str:
    """Return a line for each cell, under `COLUMNS`; what was never is left empty."""
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    for cell in cells:
        found = cell.effect
        rows.writerow(
            (
                *(cell.state, cell.failure.title, cell.failure.place, found.verdict, found.noticed_by),
                *(_rounded(found.after_ms), _rounded(found.standstill_after_ms)),
                *(_rounded(1e3 * found.goes_m), _rounded(DEGREES * found.turns_rad), f"{found.aside:.2f}"),
                cell.why if cell.late else "",
            )
        )
    return text.getvalue()


def as_page(robot: str, cells: Sequence[Cell]) -> str:
    """Return the page: a row for each failure at each place, a column for each state."""
    states = tuple(dict.fromkeys(cell.state for cell in cells))
    rows: dict[tuple[str, str], dict[str, Cell]] = {}
    for cell in cells:
        rows.setdefault((cell.failure.title, cell.failure.place), {})[cell.state] = cell
    heads = "".join(f"<th>{html.escape(it)}</th>" for it in ("failure", "at", *states))
    body = "".join(
        f"<tr><th>{html.escape(title)}</th><th>{html.escape(place)}</th>"
        f"{''.join(_cell(of[state]) for state in states)}</tr>"
        for (title, place), of in rows.items()
    )
    legend = "".join(f'<li><span class="{it.value}">{it.value}</span>: {words}</li>' for it, words in LEGEND)
    return document(
        f"{robot}: failures",
        f"<h1>Effects of each failure of {html.escape(robot)}</h1><p>Each failure was injected in each state "
        f"for two seconds, on the bench. Measured in the plant: the time of the final standstill, the "
        f"distance and the angle, including the commanded motion.</p><ul>{legend}"
        f'<li><span class="why">late or never, with a reason</span></li>'
        f'<li><span class="wrong">late or never, without a known reason</span></li></ul>'
        f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>",
        LOOK,
    )


def wrongs(cells: Sequence[Cell]) -> Iterator[str]:
    """Yield a line for each cell in which the robot moves, unnoticed and without a known reason."""
    for cell in cells:
        if cell.wrong:
            found = cell.effect
            by = "" if found.after_ms is None else f" after {found.after_ms:.0f} ms by {found.noticed_by}"
            yield (
                f"{cell.state}: {cell.failure.title} {cell.failure.place}: {found.verdict}{by}; it goes "
                f"{1e3 * found.goes_m:.0f} mm and turns {DEGREES * found.turns_rad:.0f} degrees"
            )


def _cell(cell: Cell) -> str:
    found = cell.effect
    kind = "wrong" if cell.wrong else "why" if cell.late else found.verdict.value
    who = found.noticed_by or found.verdict.value
    when = "" if found.after_ms is None else f" {found.after_ms:.0f} ms"
    motion = (
        "keeps moving" if found.standstill_after_ms is None else f"stopped {found.standstill_after_ms:.0f} ms"
    )
    way = f"{motion}, {1e3 * found.goes_m:.0f} mm, {DEGREES * found.turns_rad:.0f}°"
    why = f"<small>{html.escape(cell.why)}</small>" if cell.late and cell.why else ""
    return f'<td class="{kind}">{html.escape(who)}{when}<small>{way}</small>{why}</td>'


def _rounded(value: float | None) -> str:
    return "" if value is None else f"{value:.1f}"
