"""The arm AR2 at the command line: `emulate ar2`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.options import DurationOption
from firmware_bridge.cli.recorded import RecordOption

EXAMPLES: Final = """Examples:

`firmware-bridge emulate ar2 --serial pty --serial-link arm.tty`

`firmware-bridge emulate ar2 --firmware 1.5 --reset-on-open`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ar2Options:
    """Put the board of an AR2 arm on a serial line, in real time, with the arm on its drivers.

    For whoever writes a client and has no arm at hand. It stands at rest, as after a calibration, is on from
    the beginning, and deaf for the boot loader's 1.1 s. Joints carry their weight, and lose steps where a
    motor is too weak for it at its speed; nothing on the line says so. Ends on Ctrl-C, and then says where
    the joints truly are.
    """

    firmware: Annotated[str, typer.Option(help="The generation of its sketch: 2.0 or 1.5.")] = "2.0"
    serial: Annotated[
        str,
        typer.Option(
            metavar="pty|DEVICE", help="On a pseudo-terminal of this machine, or on a serial device."
        ),
    ] = "pty"
    serial_link: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="With --serial pty: a symbolic link to it, so that its name is always the same.",
            show_default=False,
        ),
    ] = None
    reset_on_open: Annotated[
        bool,
        typer.Option(
            "--reset-on-open",
            help="With --serial pty, on Linux: a client that opens it resets the board, as on a real one.",
        ),
    ] = False
    record: RecordOption = None
    duration: DurationOption = None


emulate: Final = command(EXAMPLES, work="emulators.cli.emulate_ar2_work:emulate")(Ar2Options)
