"""Boards of a robot on real ports, whatever is connected to them."""

from typing import TYPE_CHECKING

from firmware_bridge.robot import AnyRobot

if TYPE_CHECKING:
    from emulators.cli.emulate_robot import RobotOptions
    from emulators.cli.emulation import Emulation


def on_ports(robot: AnyRobot, given: "RobotOptions") -> "Emulation":
    """Make a robot's boards for `emulate ROBOT`."""
    from emulators.arduino_omni.commands.robot import emulate_boards  # noqa: PLC0415 - a command's own

    return emulate_boards(robot, given)
