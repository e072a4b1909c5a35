"""The plain servo at the command line."""

from typing import Final

from firmware_bridge.cli.commands import CliCommand, Row

COMMANDS: Final[tuple[Row, ...]] = (
    CliCommand(
        "emulate cia402",
        "emulators.cia402.commands.emulate:emulate",
        "Put plain CiA 402 servos on a real CAN bus, in real time.",
    ),
    CliCommand(
        "emulate canopen",
        "emulators.cia402.commands.canopen:emulate",
        "Put devices on a real CAN bus as their EDS describes them, in real time.",
    ),
)
