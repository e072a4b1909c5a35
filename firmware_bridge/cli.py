"""The command line: its own commands, and those that other installed packages attach to it.

It refuses to know the simulation: the bridge runs without it.
"""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import Annotated, Final, NoReturn, TypeAlias

import typer
from rich.console import Console
from rich.table import Table

from firmware_bridge.robot import Robot, RobotFileError, find, load, shipped

COMMAND_GROUP: Final = "firmware_bridge.commands"
"""Entry points of this group are called with the program and attach their commands to it."""
WRONG_INPUT: Final = 2
INTERRUPTED: Final = 130
NO_TERMINAL_WIDTH: Final = 120
"""A table written to a file or a pipe is not cut to the 80 columns of a terminal that is not there."""

Attach: TypeAlias = Callable[[typer.Typer], None]

program = typer.Typer(
    name="firmware-bridge",
    help="Drive a robot with maxon EPOS2 drives from an operator's MAVLink: on a CAN bus, or on the bench.",
    epilog="""Begin with one of these:

`firmware-bridge robots` lists the robots.

`firmware-bridge bench rars --mission circles` drives one in virtual time, plots included.

`firmware-bridge drive rars -i socketcan -c can0` runs the bridge on a real bus.

`firmware-bridge COMMAND --help` says more about each.""",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)

RobotArgument = Annotated[
    str,
    typer.Argument(metavar="ROBOT", help="A robot that `robots` lists, or the path of a robot file (.toml)."),
]


def terminal(*, stderr: bool = False) -> Console:
    """Return the console to print tables and progress on."""
    console = Console(stderr=stderr, highlight=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = NO_TERMINAL_WIDTH
    return console


@contextmanager
def one_message(*errors: type[Exception], status: int = WRONG_INPUT) -> Iterator[None]:
    """Turn these errors into one message on standard error and an exit status, without a traceback."""
    try:
        yield
    except errors as error:
        refuse(str(error), status)


def refuse(message: str, status: int = WRONG_INPUT) -> NoReturn:
    """End the program with one message on standard error."""
    typer.echo(f"firmware-bridge: {message}", err=True)
    raise typer.Exit(status)


def find_robot(name: str) -> Robot:
    """Return the robot of this name or file; where there is none, say so and end the program."""
    with one_message(RobotFileError):
        return find(name)


@program.callback()
def _options(
    *,
    _version: Annotated[
        bool,
        typer.Option(
            "--version",
            is_eager=True,
            callback=lambda asked: _print_version(asked=asked),
            help="Print the version and exit.",
        ),
    ] = False,
) -> None:
    """Take the options that come before the command."""


@program.command()
def robots(
    files: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[FILE]...", help="More robot files to check.", show_default=False),
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
        refuse("\n".join(map(str, wrong)))


def _print_version(*, asked: bool) -> None:
    if asked:
        typer.echo(f"firmware-bridge {metadata.version('firmware-bridge')}")
        raise typer.Exit


def attach_commands() -> None:
    """Attach the commands of every installed package that has some, in the order of their names.

    A package that cannot be imported must not keep the bridge from running: it is named and left out.
    """
    for entry in sorted(metadata.entry_points(group=COMMAND_GROUP), key=lambda entry: entry.name):
        try:
            attach: Attach = entry.load()
        except ImportError as error:
            typer.echo(f"firmware-bridge: the commands of '{entry.name}' are left out: {error}", err=True)
            continue
        attach(program)


def main() -> None:
    """Run the command line."""
    attach_commands()
    try:
        program()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
