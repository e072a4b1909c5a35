"""Options for a serial line to a drive, and the port that they ask for."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from firmware_bridge.cli.console import refusal
from firmware_bridge.shell.ports import Port, PortError, PseudoTerminal, SerialLine
from firmware_bridge.shell.ports.pseudo_terminal import WORD
from firmware_bridge.wire.canopen import FIRST_NODE, LAST_NODE
from firmware_bridge.wire.maxon.frame import Generation

SerialOption = Annotated[
    str | None,
    typer.Option(
        "--serial",
        metavar="pty|DEVICE",
        help="Put a drive on a serial line: on a pseudo-terminal of this machine, or on a device.",
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
SerialNodeOption = Annotated[
    int | None,
    typer.Option(
        min=FIRST_NODE,
        max=LAST_NODE,
        help="With --serial: which node is on the line; the others are reached through it.",
        show_default="the first",
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


def on_the_line(node: int | None, nodes: Sequence[int], *, serial: str | None) -> int:
    """Return which of these nodes is on the serial line; one that is not there ends the program."""
    if node is not None and serial is None:
        raise refusal(f"--serial-node {node}: there is no serial line; say --serial {WORD}, too")
    if node is not None and node not in nodes:
        raise refusal(f"--serial-node {node}: there is no such node; there are {', '.join(map(str, nodes))}")
    return nodes[0] if node is None else node
