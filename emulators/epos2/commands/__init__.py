"""EPOS2 drives at the command line: emulated alone or for a robot, documents."""

from typing import Final

from firmware_bridge.cli.commands import CliCommand, Row

COMMANDS: Final[tuple[Row, ...]] = (
    CliCommand(
        "emulate epos2",
        "emulators.epos2.commands.emulate:emulate",
        "Put EPOS2 drives on a real CAN bus, a serial line, or both.",
    ),
    CliCommand(
        "epos2 objects",
        "emulators.epos2.commands.documents:objects",
        "List every object: type, access, PDO, range, default, and provenance.",
    ),
    CliCommand(
        "epos2 eds",
        "emulators.epos2.commands.documents:eds",
        "Write the electronic data sheet, for any CANopen master's tools.",
    ),
    CliCommand(
        "epos2 dcf",
        "emulators.epos2.commands.documents:dcf",
        "Read every object of a running drive, emulated or real, and write its device configuration file.",
    ),
    CliCommand(
        "epos2 fidelity",
        "emulators.epos2.commands.documents:fidelity",
        "List proven, documented, analogous and assumed parts of the emulation, with their sources.",
    ),
)
