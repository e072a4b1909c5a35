"""`robots`: the robot files found, each one checked."""

from pathlib import Path
from typing import Annotated, Final

import typer
from rich.table import Table

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import refusal
from firmware_bridge.cli.tables import terminal
from firmware_bridge.robot import RobotFileError, load, shipped

EXAMPLES: Final = """Examples:

`firmware-bridge robots`

`firmware-bridge robots my_robot.toml` checks one of your own."""


@command(EXAMPLES)
def robots(
    files: Annotated[
        list[Path] | None,
        typer.Argument(metavar="FILE", help="More robot files to check.", show_default=False),
    ] = None,
) -> None:
    """List the robot files found, each one checked.

    Checks the files that come with the program and those given.
    """
    table = Table(title="robot files")
    for heading in ("robot", "axes", "bus", "file", "check"):
        table.add_column(heading, overflow="fold")
    wrong = []
    for path in [*shipped(), *(files or [])]:
        try:
            robot = load(path)
        except RobotFileError as error:
            wrong.append(error)
            table.add_row(path.stem, "", "", str(path), "[red]wrong[/]")
            continue
        axes = "\n".join(f"{axis.node} {axis.title}" for axis in robot.axes)
        bus = f"{robot.bus.bit_rate // 1000} kbit/s\nevery {robot.bus.cycle_ms} ms"
        table.add_row(f"{robot.name}\n[dim]{robot.title}[/]", axes, bus, str(path), "[green]good[/]")
    terminal().print(table)
    if wrong:
        raise refusal("\n".join(map(str, wrong)))
