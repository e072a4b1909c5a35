"""One robot, one file: the checked table, and how it is read."""

from firmware_bridge.robot.guard_table import GuardExclusive, GuardSum, GuardTable
from firmware_bridge.robot.model import (
    AnyLink,
    AnyRobot,
    Axis,
    Battery,
    CommandForm,
    Output,
    PlantFile,
    Robot,
    Sensor,
    Unit,
    Unpowered,
)
from firmware_bridge.robot.operator_link import OperatorLink, UnknownAge
from firmware_bridge.robot.problems import Problem, RobotFileError
from firmware_bridge.robot.table import Table

__all__ = [
    "AnyLink",
    "AnyRobot",
    "Axis",
    "Battery",
    "CommandForm",
    "GuardExclusive",
    "GuardSum",
    "GuardTable",
    "OperatorLink",
    "Output",
    "PlantFile",
    "Problem",
    "Robot",
    "RobotFileError",
    "Sensor",
    "Table",
    "Unit",
    "UnknownAge",
    "Unpowered",
]
