"""The program: its description, and its commands."""

import sys
import warnings
from typing import Annotated, Any, Final

import typer

from firmware_bridge.cli.commands import CliCommand, Row, Rows, Tree
from firmware_bridge.cli.console import INTERRUPTED, say, speak_plainly

COMMANDS: Final[tuple[Row, ...]] = (
    CliCommand(
        "drive",
        "firmware_bridge.cli.drive:drive",
        "Run the bridge on a real CAN bus or serial line.",
    ),
    CliCommand(
        "pilot",
        "firmware_bridge.cli.pilot:pilot",
        "Drive a robot over its operator's link: by hand, or along a path.",
    ),
    CliCommand(
        "robots",
        "firmware_bridge.cli.robots:robots",
        "List the robots that are installed, each file checked.",
    ),
    CliCommand(
        "families",
        "firmware_bridge.cli.families:shown",
        "List the families of devices: links, axes, reports, watchdog and robots.",
    ),
    CliCommand(
        "monitor",
        "firmware_bridge.cli.monitor:monitor",
        "Show a CAN bus decoded: nodes, PDOs, statuswords, emergencies, rates, load, the last error.",
    ),
    CliCommand(
        "live",
        "firmware_bridge.cli.live:live",
        "Play a recording in MCAP on a page for a browser of this machine, whose address is printed.",
    ),
    CliCommand(
        "explain",
        "firmware_bridge.cli.explain:explain",
        "Explain a recording of a bus or a line, or a code: incidents, causes, why a drive does not move.",
    ),
)


class CommandGroup(Rows):
    """The program's own commands, and those of every installed package that has some."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        Tree(self, COMMANDS)


program = typer.Typer(
    name="firmware-bridge",
    cls=CommandGroup,
    help="maxon EPOS2 drives, Arduino boards with motor shields, AR2 arms and robots made of them: emulated, "
    "or driven from an operator's MAVLink with interlocks.",
    epilog="""\b
Begin with one of these:
  firmware-bridge robots                           the robots
  firmware-bridge bench rars --mission circles     one driven in virtual time, plots included
  firmware-bridge drive rars -i socketcan -c can0  the bridge on a real bus
  firmware-bridge COMMAND --help                   each command; --install-completion is for your shell""",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@program.callback()
def _options(
    *,
    _version: Annotated[
        bool,
        typer.Option(
            "--version",
            is_eager=True,
            callback=lambda requested: _print_version(requested=requested),
            help="Print the version and exit.",
        ),
    ] = False,
) -> None:
    """Take the options that come before the command."""


def _warn(message: Warning | str, *_place: object, **_more: object) -> None:
    """Print a warning in one line, without the place in the code that it comes from."""
    say(f"firmware-bridge: warning: {message}", err=True)


def _print_version(*, requested: bool) -> None:
    if requested:
        from importlib import metadata

        say(f"firmware-bridge {metadata.version('firmware-bridge')}")
        raise typer.Exit


def main() -> None:
    """Run the command line."""
    speak_plainly()
    warnings.showwarning = _warn
    try:
        program()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
