"""The serial line of one emulated board: its options, and what opens it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from emulators.cli.options import LineLinkOption, LineOption
from firmware_bridge.cli.console import refusal
from firmware_bridge.node import SERIAL

if TYPE_CHECKING:
    from firmware_bridge.cli.links import Openers


@dataclass(frozen=True, slots=True, kw_only=True)
class LineOptions:
    """Options of a board's serial line."""

    serial: LineOption = "pty"
    serial_link: LineLinkOption = None
    reset_on_open: Annotated[
        bool,
        typer.Option(
            "--reset-on-open",
            help="With --serial pty, on Linux: a client that opens it resets the board, as on a real one.",
        ),
    ] = False

    @property
    def on_pty(self) -> bool:
        """True where the line is a pseudo-terminal, whose cable can be pulled."""
        from firmware_bridge.runtime.ports.pseudo_terminal import WORD

        return self.serial == WORD


def line_opened(given: LineOptions, baud: int) -> "tuple[Openers, str]":
    """Open the line at once, because its name is found out only then; PortError."""
    from firmware_bridge.cli.links import open_serial

    line = open_serial(given.serial, baud, given.serial_link, reports_dtr=given.reset_on_open)
    return {SERIAL: lambda: line}, line.name


def checked(given: LineOptions) -> None:
    """End the program with a message where an option is of a pseudo-terminal alone."""
    if given.reset_on_open and not given.on_pty:
        raise refusal(
            f"--reset-on-open: on {given.serial} the device itself decides; only --serial pty needs it"
        )
