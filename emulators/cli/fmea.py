"""`fmea`: every failure in every state of a robot, at the command line."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.options import EncodersOption, FirmwareOption, RobotArgument
from firmware_bridge.wire.maxon.frame import Generation

EXAMPLES: Final = """Examples:

`firmware-bridge fmea rars --out out/fmea`

`firmware-bridge fmea rome --protocol mw --encoders 3 --fault encoder_cable_off --fault board_reset`

`firmware-bridge fmea climber --state stopping`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FmeaOptions:
    """Try every fault in every state of a robot, and say who notices, when, and how far it goes.

    In virtual time, on all processors: minutes. Ends with status 1 where the robot does something that nobody
    asked for, nobody notices within half a second, and no reason is known. With `--out` it leaves `fmea.csv`
    and `fmea.html`, the matrix on one page. How bad a fault is made stands in the page's titles.
    """

    robot: RobotArgument
    faults: Annotated[
        list[str] | None,
        typer.Option("--fault", metavar="KIND", help="This kind; may be said again.", show_default="all"),
    ] = None
    states: Annotated[
        list[str] | None,
        typer.Option("--state", metavar="STATE", help="This state; may be said again.", show_default="all"),
    ] = None
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="DIR", help="Where the matrix goes.", show_default="nowhere"),
    ] = None
    jobs: Annotated[int, typer.Option("--jobs", "-j", min=1, help="How many processes share the work.")] = (
        os.cpu_count() or 1
    )
    serial: Annotated[
        Generation | None,
        typer.Option("--serial", help="Over the first drive's serial port.", show_default="as the file says"),
    ] = None
    protocol: FirmwareOption = None
    encoders: EncodersOption = None


fmea: Final = command(EXAMPLES, work="emulators.cli.fmea_work:fmea")(FmeaOptions)
