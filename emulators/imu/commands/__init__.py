"""Emulated IMUs at the command line."""

from typing import Final

from firmware_bridge.cli.commands import CliCommand, Row

COMMANDS: Final[tuple[Row, ...]] = (
    CliCommand(
        "emulate imu",
        "emulators.imu.commands.imu:emulate",
        "Send the frames of an IMU on a serial line, in real time.",
    ),
)
