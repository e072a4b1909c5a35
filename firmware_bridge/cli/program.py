"""The program: what it says of itself, and which commands it has."""

import sys
import warnings
from collections.abc import Callable
from importlib import metadata
from typing import Annotated, Final, TypeAlias

import typer

from firmware_bridge.cli import drive, epos2, robots
from firmware_bridge.cli.console import INTERRUPTED

COMMAND_GROUP: Final = "firmware_bridge.commands"
"""Entry points of this group are called with the program and attach their commands to it."""

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
program.command(epilog=drive.EXAMPLES)(drive.drive)
program.command(epilog=robots.EXAMPLES)(robots.robots)
program.add_typer(epos2.group, name="epos2", epilog=epos2.EXAMPLES)


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


def _warn(message: Warning | str, *_place: object, **_more: object) -> None:
    """Print a warning in one line, without the place in the code that it comes from."""
    typer.echo(f"firmware-bridge: warning: {message}", err=True)


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
    warnings.showwarning = _warn
    attach_commands()
    try:
        program()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
