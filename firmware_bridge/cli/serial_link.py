"""Options for a serial line to a drive, and the port that they ask for."""

from pathlib import Path
from typing import Annotated

import typer

from firmware_bridge.shell.ports import Port, PortError, PseudoTerminal, SerialLine
from firmware_bridge.shell.ports.pseudo_terminal import WORD
from firmware_bridge.wire.maxon.frame import Generation

SerialOption = Annotated[
    str | None,
    typer.Option(
        "--serial",
        metavar="pty|DEVICE",
        help="Put the first drive on a serial line: on a pseudo-terminal of this machine, or on a device.",
        show_default=False,
    ),
]
SerialLinkOption = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="With --serial pty: a symbolic link to it, so that its name is always the same.",
        show_default=False,
    ),
]
ProtocolOption = Annotated[
    Generation, typer.Option(help="What the serial line speaks: v1 as on RS232, v2 as on USB.")
]


def open_serial(device: str, baud: int, link: Path | None = None) -> Port:
    """Open a serial device, or make a pseudo-terminal with a link to it; PortError."""
    if device == WORD:
        return PseudoTerminal(link)
    if link is not None:
        raise PortError(f"--serial-link {link}: only a pseudo-terminal wants a link; say --serial {WORD}")
    return SerialLine(device, baud)
