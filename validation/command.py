"""`study`: a source's figures and numbers, made again, at the command line."""

import importlib
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.cli.options import CORES, JobsOption
from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.console import FAILED, one_message, refusal, say, written_by

if TYPE_CHECKING:
    from validation.studies.study import Compared, Findings, Study


REPORT: Final = "studies.html"


EXAMPLES: Final = """Examples:

`firmware-bridge study --list`

`firmware-bridge study tipping --out out/tipping`

`firmware-bridge study all --out out/studies` makes one page of all, `out/studies/studies.html`."""


@command(EXAMPLES)
def study(
    *,
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="Which one, or `all`.",
            autocompletion=completing("validation.studies.shelf:study_names"),
        ),
    ] = None,
    every: Annotated[bool, typer.Option("--list", help="List the studies, with their sources.")] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="Take fewer points and shorter runs; the bounds are the same.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR", help="Where tables and pictures go.", show_default="nowhere"
        ),
    ] = None,
    jobs: JobsOption = CORES,
) -> None:
    """Reproduce a source's figures and numbers: printed, independent, ours, and why they differ.

    Ends with status 1 where one of our numbers is not within its bound of the independent one.
    """
    from emulators.campaign.spread import SpreadError, in_order
    from validation.studies.shelf import studies
    from validation.studies.study import chosen

    if every:
        _list()
        return
    if name is None:
        raise refusal("study needs a name, or --list to see which there are")
    with one_message(LookupError, SpreadError), written_by("--out"):
        if out is not None:
            _drawing()
        wanted = chosen(studies(), name)
        found = in_order(partial(_made, quick=quick), wanted, jobs)
        made = [(one, _shown(one, findings, out)) for one, findings in zip(wanted, found, strict=True)]
        if out is not None:
            _report(made, out)
    wrong = [f"{one.name}: {row.quantity}" for one, found in made for row in found.out_of_bounds]
    if wrong:
        raise refusal(f"out of bounds: {'; '.join(wrong)}", FAILED)


def _drawing() -> ModuleType:
    """Import what draws: half a second for Matplotlib, which no one needs who wants no pictures."""
    from firmware_bridge.extras import from_extras

    with from_extras():
        return importlib.import_module("validation.studies.report")


def _list() -> None:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from firmware_bridge.cli.tables import terminal
    from validation.studies.shelf import studies_by_robot

    table = Table(box=SIMPLE_HEAD)
    for heading in ("study", "robot", "what", "source"):
        table.add_column(heading, overflow="fold")
    with one_message(LookupError):
        for robot, rows in studies_by_robot().items():
            for one in rows:
                table.add_row(one.name, robot, one.title, one.source)
    terminal().print(table)


def _made(one: "Study", *, quick: bool) -> "Findings":
    return one.made(quick=quick)


def _shown(one: "Study", findings: "Findings", out: Path | None) -> "Findings":
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from firmware_bridge.cli.tables import terminal

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


def _cells(row: "Compared") -> tuple[str, ...]:
    from validation.studies.study import cell

    ours = cell(row.ours) if row.holds else f"{cell(row.ours)} (out of bounds: ± {cell(row.within)})"
    return row.quantity, row.unit, cell(row.printed), cell(row.independent), ours, row.why


def _report(made: "list[tuple[Study, Findings]]", out: Path) -> None:
    place = out / REPORT
    place.write_text(_drawing().page(made), encoding="utf-8")
    say(f"report: {place}")
