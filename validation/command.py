"""`study`: a source's figures and numbers, made anew, at the command line."""

from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command, completing

EXAMPLES: Final = """Examples:

`firmware-bridge study --list`

`firmware-bridge study tipping --out out/tipping`

`firmware-bridge study all --out out/studies` makes one page of all, `out/studies/studies.html`."""


@command(EXAMPLES, work="validation.at_the_terminal:study")
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
) -> None:
    """Make a source's figures and numbers anew: printed, independent, ours, and why they differ.

    Ends with status 1 where one of our numbers is not within its bound of the independent one.
    """
