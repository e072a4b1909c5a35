"""The robot of a run: the named one, with the command's settings of its links and its path."""

from pathlib import Path
from typing import Protocol

from firmware_bridge.cli.fitted import driven
from firmware_bridge.family import LinkOptions
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.path_file import Point, along_path


class Fitting(Protocol):
    """A command's settings of a robot's links and path; None: as in its file."""

    @property
    def serial(self) -> str | None:
        """Drives over a serial line, in this protocol."""

    @property
    def protocol(self) -> str | None:
        """The firmware of a board."""

    @property
    def encoders(self) -> int | None:
        """Number of encoders that a board reads."""

    @property
    def path(self) -> Path | None:
        """A file of points."""

    @property
    def path_speed(self) -> float | None:
        """Speed along points without times, in m/s."""


def fitted(robot: AnyRobot, given: Fitting) -> tuple[AnyRobot, tuple[Point, ...]]:
    """Return the robot so connected, and the points of its path file, none without one.

    RobotFileError, PathFileError where that does not suit it.
    """
    firm = linked(robot, given.serial, given.protocol, given.encoders)
    return along_path(firm, given.path, given.path_speed)


def linked(robot: AnyRobot, serial: str | None, protocol: str | None, encoders: int | None) -> AnyRobot:
    """Return the robot on the links that a command has named; RobotFileError where that does not suit it."""
    lines = () if serial is None else tuple(robot.links)
    return driven(robot, LinkOptions(serial or protocol, encoders=encoders, lines=lines))
