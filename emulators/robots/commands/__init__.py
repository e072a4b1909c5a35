"""New robots at the command line: `new`."""

from typing import Final

from firmware_bridge.cli.commands import CliCommand, Row

COMMANDS: Final[tuple[Row, ...]] = (
    CliCommand(
        "new",
        "emulators.robots.commands.new:new",
        "Write a new robot that drives at once: a package for two wheels, else a robot file.",
    ),
)
