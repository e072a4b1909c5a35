"""The robot that the user names."""

from firmware_bridge import robot_types
from firmware_bridge.cli.console import one_message
from firmware_bridge.robot import AnyRobot, RobotFileError


def names() -> list[str]:
    """Return the completions of a robot argument."""
    return list(robot_types.names())


def find_robot(name: str) -> AnyRobot:
    """Return the robot of this name or file; report a missing one and end the program."""
    with one_message(RobotFileError):
        return robot_types.find(name)
