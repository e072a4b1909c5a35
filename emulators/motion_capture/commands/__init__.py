"""Emulated motion capture systems at the command line."""

from typing import Final

from firmware_bridge.cli.commands import CliCommand, Row

COMMANDS: Final[tuple[Row, ...]] = (
    CliCommand(
        "emulate motion_capture",
        "emulators.motion_capture.commands.capture:emulate",
        "Stream the frames of an OptiTrack system as NatNet over UDP unicast, in real time.",
    ),
    CliCommand(
        "emulate capture",
        "emulators.motion_capture.commands.capture:emulate",
        "Stream the frames of an OptiTrack system as NatNet over UDP unicast, in real time.",
    ),
)
