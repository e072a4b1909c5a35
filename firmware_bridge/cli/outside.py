"""Options of emulated drives: the links on which they meet the rest of the world."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from firmware_bridge.canopen.cia301 import FIRST_NODE, LAST_NODE
from firmware_bridge.cli.options import BitRateOption, ChannelOption, InterfaceOption


@dataclass(frozen=True, slots=True, kw_only=True)
class Outside:
    """A CAN bus, a serial line, or both."""

    interface: InterfaceOption = None
    channel: ChannelOption = None
    bit_rate: BitRateOption = None
    serial: Annotated[
        str | None,
        typer.Option(
            "--serial",
            metavar="pty|DEVICE",
            help="Put a drive on a serial line: a pseudo-terminal of this machine, or a device.",
            show_default=False,
        ),
    ] = None
    serial_link: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="With --serial pty: a symbolic link to it, so that its name is always the same.",
            show_default=False,
        ),
    ] = None
    serial_node: Annotated[
        int | None,
        typer.Option(
            min=FIRST_NODE,
            max=LAST_NODE,
            help="With --serial: the node on the line; the others are reached through it.",
            show_default="the first",
        ),
    ] = None
