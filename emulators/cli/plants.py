"""The plants' commands: `fmu list`, `fmu build`, `fmu check`."""

from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command, completing

LIST_EXAMPLE: Final = "Example: `firmware-bridge fmu list`"
BUILD_EXAMPLES: Final = """Examples:

`firmware-bridge fmu build rars`

`firmware-bridge fmu build rars --fmi 2 --out results/rars2.fmu`"""
CHECK_EXAMPLE: Final = "Example: `firmware-bridge fmu check my_plant.fmu`"


@command(LIST_EXAMPLE, work="emulators.cli.plants_work:list_models")
def list_models() -> None:
    """List the models that can be built."""


@command(BUILD_EXAMPLES, work="emulators.cli.plants_build:build_model")
def build_model(
    model: Annotated[
        str,
        typer.Argument(
            metavar="MODEL",
            help="A model that `fmu list` shows.",
            autocompletion=completing("fmu.plants:names"),
        ),
    ],
    *,
    fmi: Annotated[int, typer.Option("--fmi", min=2, max=3, help="The version of FMI: 2 or 3.")] = 3,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help="Where it goes.", show_default="MODEL.fmu"),
    ] = None,
) -> None:
    """Build a model's FMU, with its sources inside.

    It holds a binary for this machine, and for Linux and Windows on x86-64 and Linux on ARM where their
    compilers are.
    """


@command(CHECK_EXAMPLE, work="emulators.cli.plants_work:check")
def check(file: Annotated[Path, typer.Argument(metavar="FILE", help="An FMU, whoever made it.")]) -> None:
    """Check whether an FMU is valid, starts, computes the right bits, and fits a robot on the bench.

    Exit status 0: it does; 1: it has problems; 2: it cannot be read.
    """
