"""A robot with a command's options of its links, by the families of its devices."""

from firmware_bridge.cli.console import refusal
from firmware_bridge.family import LinkOptions, family_of
from firmware_bridge.robot import AnyRobot


def linked(robot: AnyRobot, options: LinkOptions) -> AnyRobot:
    """Return the robot on its links by these options; RobotFileError where they do not suit.

    An option that none of its devices takes ends the program with a message.
    """
    own = tuple(dict.fromkeys(family_of(link) for link in robot.links.values()))
    for option in sorted(options.given):
        if not any(option in family.takes for family in own):
            titles = ", ".join(family.title for family in own)
            raise refusal(f"--{option}: {robot.name} has nothing that takes it, but {titles}")
    for family in own:
        robot = family.over(robot, options)
    return robot


def driven(robot: AnyRobot, options: LinkOptions) -> AnyRobot:
    """Return the robot so linked; RobotFileError also where it lacks what it cannot be driven without."""
    robot = linked(robot, options)
    for link in robot.links.values():
        robot = family_of(link).drivable(robot)
    return robot
