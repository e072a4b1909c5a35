"""The robot that the user names."""

from firmware_bridge.cli.console import one_message
from firmware_bridge.robot import Robot, RobotFileError, find, shipped


def names() -> list[str]:
    """Return what a shell completes where a robot is wanted."""
    return [path.stem for path in shipped()]


def find_robot(name: str) -> Robot:
    """Return the robot of this name or file; where there is none, say so and end the program."""
    with one_message(RobotFileError):
        return find(name)
