"""Makes studies, shows what is compared, and writes tables, pictures and the report."""

import importlib
from pathlib import Path
from types import ModuleType
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.table import Table

from emulators.extras import from_extras
from firmware_bridge.cli.console import FAILED, one_message, refusal, say, written_by
from firmware_bridge.cli.tables import terminal
from validation.studies.shelf import studies, studies_by_robot
from validation.studies.study import Compared, Findings, Study, cell, chosen

REPORT: Final = "studies.html"


def study(*, name: str | None, every: bool, quick: bool, out: Path | None) -> None:
    """Do what `study` says; what is wrong ends the program with a message."""
    if every:
        _list()
        return
    if name is None:
        raise refusal("study needs a name, or --list to see which there are")
    with one_message(LookupError), written_by("--out"):
        if out is not None:
            _drawing()
        made = [(one, _one(one, quick=quick, out=out)) for one in chosen(studies(), name)]
        if out is not None:
            _report(made, out)
    wrong = [f"{one.name}: {row.quantity}" for one, found in made for row in found.out_of_bounds]
    if wrong:
        raise refusal(f"out of bounds: {'; '.join(wrong)}", FAILED)


def _drawing() -> ModuleType:
    """Import what draws: half a second for Matplotlib, which nobody needs who wants no pictures."""
    with from_extras():
        return importlib.import_module("validation.studies.report")


def _list() -> None:
    table = Table(box=SIMPLE_HEAD)
    for heading in ("study", "robot", "what", "source"):
        table.add_column(heading, overflow="fold")
    with one_message(LookupError):
        for robot, rows in studies_by_robot().items():
            for one in rows:
                table.add_row(one.name, robot, one.title, one.source)
    terminal().print(table)


def _one(one: Study, *, quick: bool, out: Path | None) -> Findings:
    findings = one.made(quick=quick)
    say(f"{one.title}\n{one.source}")
    table = Table(box=SIMPLE_HEAD)
    for heading in ("quantity", "unit"):
        table.add_column(heading, overflow="fold")
    for heading in ("printed", "independent", "ours"):
        table.add_column(heading, justify="right")
    table.add_column("why they differ", overflow="fold", style="dim")
    for row in findings.compared:
        table.add_row(*_cells(row))
    terminal().print(table)
    for remark in findings.remarks:
        say(f"  {remark}")
    if out is not None:
        _drawing().write(out / one.name, findings)
    return findings


def _cells(row: Compared) -> tuple[str, ...]:
    ours = cell(row.ours) if row.holds else f"{cell(row.ours)} (out of bounds: ± {cell(row.within)})"
    return row.quantity, row.unit, cell(row.printed), cell(row.independent), ours, row.why


def _report(made: list[tuple[Study, Findings]], out: Path) -> None:
    place = out / REPORT
    place.write_text(_drawing().page(made), encoding="utf-8")
    say(f"report: {place}")
