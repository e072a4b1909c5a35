"""One robot, one file: the checked table, and where it is read from."""

from firmware_bridge.robot.bus import Bus, Link
from firmware_bridge.robot.file import RobotFileError, find, load, parse, shipped
from firmware_bridge.robot.model import (
    Axis,
    Base,
    Battery,
    Gains,
    Lift,
    Limits,
    Mode,
    OperatorLink,
    PlantFile,
    Profile,
    Robot,
    Role,
)

__all__ = [
    "Axis",
    "Base",
    "Battery",
    "Bus",
    "Gains",
    "Lift",
    "Limits",
    "Link",
    "Mode",
    "OperatorLink",
    "PlantFile",
    "Profile",
    "Robot",
    "RobotFileError",
    "Role",
    "find",
    "load",
    "parse",
    "shipped",
]
