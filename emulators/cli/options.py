"""Options that more than one of the simulation's commands takes."""

from pathlib import Path
from typing import Annotated

import typer

PlantOption = Annotated[
    Path | None,
    typer.Option(
        "--plant",
        metavar="FMU",
        help="Another plant: an FMU (FMI 2.0 or 3.0, co-simulation) with the same variable names.",
        show_default=False,
    ),
]
LatencyOption = Annotated[
    bool,
    typer.Option(
        "--realistic-latency/--no-latency",
        help="Answer SDO requests after the time that maxon has published, or at once.",
    ),
]
