"""Output of studies: a folder of tables and pictures for each, and one page of HTML for all."""

import csv
import html
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final

from emulators.bench.web import document, picture
from validation.studies.picture import pictures
from validation.studies.study import Cell, Compared, Findings, Sheet, Study, cell

HEADINGS: Final = ("quantity", "unit", "printed", "independent", "ours", "bound", "holds", "why")


def cells(row: Compared) -> tuple[Cell | None, ...]:
    """Return a comparison under the `HEADINGS`."""
    held = "yes" if row.holds else "NO"
    return row.quantity, row.unit, row.printed, row.independent, row.ours, row.within, held, row.why


def write(folder: Path, findings: Findings) -> None:
    """Write `comparison.csv`, every other table and curve, and the pictures; OSError where it cannot."""
    folder.mkdir(parents=True, exist_ok=True)
    _table(folder / "comparison.csv", HEADINGS, map(cells, findings.compared))
    for number, sheet in enumerate(findings.sheets, 1):
        _table(folder / f"table{number}.csv", sheet.columns, sheet.rows)
    for number, plot in enumerate(findings.plots, 1):
        rows = (
            (curve.label, float(x), float(y))
            for curve in plot.curves
            for x, y in zip(curve.x, curve.y, strict=True)
        )
        _table(folder / f"figure{number}.csv", ("curve", plot.x, plot.y), rows)
        vector, raster = pictures(plot)
        (folder / f"figure{number}.svg").write_bytes(vector)
        (folder / f"figure{number}.png").write_bytes(raster)


def page(made: Sequence[tuple[Study, Findings]]) -> str:
    """Return one page of HTML that needs no other file."""
    contents = "".join(f'<li><a href="#{one.name}">{html.escape(one.title)}</a></li>' for one, _ in made)
    body = "".join(part for study, findings in made for part in _section(study, findings))
    stated = (
        "Each states what its source has printed, what an independent way gives, what ours gives, and why "
        "they differ. A bound is how far ours may be from the independent value."
    )
    return document("Studies", f"<h1>Studies</h1><p>{stated}</p><ol>{contents}</ol>{body}")


def _section(study: Study, findings: Findings) -> Iterator[str]:
    yield f'<h2 id="{study.name}">{html.escape(study.title)}</h2>'
    yield f'<p class="pale">{html.escape(study.source)} · <code>study {study.name}</code></p>'
    for remark in findings.remarks:
        yield f"<p>{html.escape(remark)}</p>"
    if findings.compared:
        yield _html_table(HEADINGS, map(cells, findings.compared))
    for plot in findings.plots:
        yield f"<figure>{picture(pictures(plot)[0], 'svg+xml', plot.title)}"
        yield f"<figcaption>{html.escape(plot.caption)}</figcaption></figure>"
    for sheet in findings.sheets:
        yield from _sheet(sheet)


def _sheet(sheet: Sheet) -> Iterator[str]:
    yield f"<h3>{html.escape(sheet.title)}</h3>"
    yield _html_table(sheet.columns, sheet.rows)


def _html_table(headings: Iterable[str], rows: Iterable[Sequence[Cell | None]]) -> str:
    head = "".join(f"<th>{html.escape(heading)}</th>" for heading in headings)
    body = "".join(f"<tr>{''.join(map(_html_cell, row))}</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _html_cell(value: Cell | None) -> str:
    if isinstance(value, str):
        look = ' class="wrong"' if value == "NO" else ""
        return f"<td{look}>{html.escape(value)}</td>"
    return f'<td class="number">{cell(value)}</td>'


def _table(path: Path, headings: Iterable[str], rows: Iterable[Iterable[Cell | None]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(headings)
        writer.writerows(rows)
