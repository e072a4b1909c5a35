"""Options of the commands that speak to one drive: which drive, over which link."""

from typing import Annotated

import typer

from firmware_bridge.wire.canopen import ALL_NODES, FIRST_NODE, LAST_NODE
from firmware_bridge.wire.maxon.frame import Generation

NodeOption = Annotated[
    int | None,
    typer.Option(
        "--node",
        "-n",
        min=FIRST_NODE,
        max=LAST_NODE,
        help="Its number; on a serial line, another one than that of the drive there goes through it.",
        show_default="1; with --serial the drive on the line",
    ),
]
NetworkNodeOption = Annotated[
    int | None,
    typer.Option(
        "--node",
        "-n",
        min=ALL_NODES,
        max=LAST_NODE,
        help="Its number, 0 for all nodes.",
        show_default="1; with --serial the drive on the line",
    ),
]
SerialPortOption = Annotated[
    str | None,
    typer.Option(
        "--serial",
        metavar="DEVICE",
        help="A serial line to a drive in place of the CAN bus: /dev/ttyUSB0, or a pseudo-terminal's path.",
        show_default=False,
    ),
]
BaudOption = Annotated[
    int | None,
    typer.Option(
        min=1200, max=4_000_000, help="Bits a second on the line.", show_default="115200; 1000000 with v2"
    ),
]
LineProtocolOption = Annotated[
    Generation | None,
    typer.Option(help="What the line speaks: v1 as on RS232, v2 as on USB.", show_default="v1"),
]
GatewayOption = Annotated[
    int | None,
    typer.Option(
        min=FIRST_NODE,
        max=LAST_NODE,
        help="The drive on the line is this node. It is asked first; where it is another, nothing is done.",
        show_default=False,
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="For programs.")]
YesOption = Annotated[
    bool, typer.Option("--yes", "-y", help="Do not ask, even where something may start to move.")
]
