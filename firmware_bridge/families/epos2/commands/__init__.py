"""One EPOS2 at the command line: its commands, a module each."""

from typing import Final

from firmware_bridge.cli.commands import CliCommand, Group, Row

COMMANDS: Final[tuple[Row, ...]] = (
    Group(
        "epos2",
        "One EPOS2 drive, real or emulated, over CAN or a serial line: its objects, its state.",
        """\b
Examples:
  firmware-bridge epos2 read statusword "profile velocity" -i socketcan -c can0 --node 3
  firmware-bridge epos2 write profile-velocity 500rpm --serial /dev/ttyUSB0
  firmware-bridge epos2 state --serial /dev/ttyUSB0 --protocol v2""",
    ),
    CliCommand(
        "epos2 scan",
        "firmware_bridge.families.epos2.commands.scan:scan",
        "List the nodes on a CAN bus, or behind a serial line: device, versions, serial number, states.",
    ),
    CliCommand(
        "epos2 read",
        "firmware_bridge.families.epos2.commands.read:read",
        "Read objects of a drive, with their names, units, and decoded bits.",
    ),
    CliCommand(
        "epos2 write",
        "firmware_bridge.families.epos2.commands.write:write",
        "Write one object of a drive.",
    ),
    CliCommand(
        "epos2 state",
        "firmware_bridge.families.epos2.commands.state:state",
        "Show a drive's power state, mode, network state and errors.",
    ),
    CliCommand(
        "epos2 version",
        "firmware_bridge.families.epos2.commands.version:version",
        "Show a drive's name, hardware, firmware and serial number.",
    ),
    CliCommand(
        "epos2 nmt",
        "firmware_bridge.families.epos2.commands.network:nmt",
        "Send a network command, and check that one drive executes it.",
    ),
)
