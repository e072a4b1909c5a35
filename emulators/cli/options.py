"""Options that more than one of the simulation's commands takes."""

import os
from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.console import refusal, say
from firmware_bridge.extras import installed, remedy_of
from firmware_bridge.mcap_file.channels import SUFFIX
from firmware_bridge.runtime.can_files import SUFFIXES

PlantOption = Annotated[
    Path | None,
    typer.Option(
        "--plant",
        metavar="FMU",
        help="Another plant: an FMU (FMI 2.0 or 3.0, co-simulation) with the same variable names.",
        show_default=False,
    ),
]
RunFileOption = Annotated[
    Path | None,
    typer.Option(
        "--record",
        metavar="FILE",
        help="Record the run in this file, too; one seed gives one file. A name that ends in .mcap is for "
        "Foxglove or PlotJuggler; in .asc, .blf or .trc, of CAN frames, for the tools of Vector and PEAK.",
        show_default=False,
    ),
]
LineOption = Annotated[
    str,
    typer.Option(metavar="pty|DEVICE", help="On a pseudo-terminal of this machine, or on a serial device."),
]
LineLinkOption = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="With --serial pty: a symbolic link to it, so that its name is always the same.",
        show_default=False,
    ),
]
SerialOption = Annotated[
    str | None,
    typer.Option(
        "--serial",
        metavar="v1|v2",
        help="Drive over the first drive's serial port instead of CAN, v1 as on RS232 or v2 as on USB.",
        show_default="by the robot file",
    ),
]
JobsOption = Annotated[int, typer.Option("--jobs", "-j", min=1, help="Number of processes.")]
CORES: Final = os.cpu_count() or 1
"""As many processes as this machine has processors."""
ParametersOption = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER",
        help="Where 'save' (0x1010) keeps parameters over restarts, in a file for each node.",
        show_default="they are forgotten at the end",
    ),
]
ControlOption = Annotated[
    str,
    typer.Option(
        metavar="WHERE",
        help="Port for `inject`: unix, a socket of this user in the runtime folder; tcp or tcp:PORT on "
        "loopback, with a token; or none.",
    ),
]
FaultOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="KIND[,KEY=VALUE][@FROM[-TO]]",
        help="A fault of a mission, as shaft_blocked,node=M1@20-30, from and to a time in s; may be "
        "repeated. `firmware-bridge faults` lists those of a device or a robot.",
        show_default=False,
    ),
]
LatencyOption = Annotated[
    bool,
    typer.Option(
        "--realistic-latency/--no-latency",
        help="Delays: answer SDO requests after the time published by maxon and start 262.5 ms after a "
        "reset, as recorded; or both at once.",
    ),
]


def run_file(path: Path | None) -> Path | None:
    """Return the file of a run; another name, or a missing extra, ends the program with a message."""
    if path is None:
        return None
    if path.suffix.lower() not in SUFFIXES:
        known = f"{', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}"
        raise refusal(f"--record {path}: name a file that ends in {known}; --out names the results' folder")
    if path.suffix.lower() == SUFFIX and not installed("mcap"):
        raise refusal(remedy_of("mcap"))
    return path


def plant_file(plant: str) -> Path:
    """Return the FMU of this name: a file, or a plant that is built where that has not been done."""
    from fmu.build import ensure, is_built

    path = Path(plant)
    if path.suffix == ".fmu" or path.exists():
        return path
    if not is_built(plant):
        say(f"building the plant {plant}, once")
    return ensure(plant)
