"""Emulated boards at the command line."""

from typing import Final

from firmware_bridge.cli.commands import CliCommand, Row

COMMANDS: Final[tuple[Row, ...]] = (
    CliCommand(
        "emulate motor_shield",
        "emulators.arduino_omni.commands.board:emulate",
        "Put an Arduino Mega 2560 with an Adafruit Motor Shield V2 on a serial line.",
    ),
    CliCommand(
        "emulate board",
        "emulators.arduino_omni.commands.board:emulate",
        "Put an Arduino Mega 2560 with an Adafruit Motor Shield V2 on a serial line.",
    ),
    CliCommand(
        "emulate ar2",
        "emulators.arduino_omni.commands.ar2:emulate",
        "Put the board of an AR2 arm on a serial line, in real time, with the arm on its drivers.",
    ),
)
