"""Options of these commands: which drive, over which link; values below zero; options that need no value."""

import re
from typing import Annotated, Any, Final

import typer

from firmware_bridge.canopen.cia301 import ALL_NODES, FIRST_NODE, LAST_NODE
from firmware_bridge.cli.usage import PlainCommand
from firmware_bridge.families.epos2.maxon.frame import Generation


def _node(least: int, what: str) -> Any:
    return typer.Option(
        "--node",
        "-n",
        min=least,
        max=LAST_NODE,
        help=f"Its number{what}.",
        show_default="1; with --serial the drive on the line",
    )


NodeOption = Annotated[
    int | None,
    _node(FIRST_NODE, "; on a serial line, another one than that of the drive there goes through it"),
]
NetworkNodeOption = Annotated[int | None, _node(ALL_NODES, ", 0 for all nodes")]
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
        min=1200,
        max=4_000_000,
        help="Bit rate of the line, in bit/s.",
        show_default="115200; 1000000 with v2",
    ),
]
LineProtocolOption = Annotated[
    Generation | None,
    typer.Option(help="Protocol of the line: v1 as on RS232, v2 as on USB.", show_default="v1"),
]
GatewayOption = Annotated[
    int | None,
    typer.Option(
        min=FIRST_NODE,
        max=LAST_NODE,
        help="Expected node number of the drive on the line. It is queried first; if it differs, nothing "
        "is done.",
        show_default=False,
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Output for programs, as JSON.")]
YesOption = Annotated[
    bool,
    typer.Option("--yes", "-y", help="Do not ask for confirmation, even if something may start to move."),
]


_NEGATIVE: Final = re.compile(r"-\d.*")
_NUMBER: Final = re.compile(r"\d+(\.\d+)?")
_REST: Final = "--"
WATCH: Final = ("--watch", "-w")
PERIOD: Final = "0.2"
"""Seconds between two looks where none are given."""


class NegativeValue(PlainCommand):
    """A command that accepts `-500qc` as its last argument, and not as a row of short options."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put values below zero behind everything else."""
        if _REST in args:
            return super().parse_args(ctx, args)
        # The parser takes -500 for options; behind '--' it is a value.
        below = [word for word in args if _NEGATIVE.fullmatch(word)]
        others = [word for word in args if not _NEGATIVE.fullmatch(word)]
        return super().parse_args(ctx, [*others, _REST, *below] if below else others)


class OptionalPeriod(PlainCommand):
    """A command that accepts `--watch` or `-w` alone, too: the next word is its value only if a number."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Give a lonely option its value."""
        full: list[str] = []
        for word, following in zip(args, [*args, ""][1:], strict=True):
            lonely = word in WATCH and not _NUMBER.fullmatch(following)
            full += [word, PERIOD] if lonely else [word]
        return super().parse_args(ctx, full)
