"""The board of an AR2 arm as one link of the robot."""

from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.ar2.driver.board import Ar2Board
from firmware_bridge.families.ar2.driver.joint import Ar2Joint
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.units import MICROSECOND, MILLISECOND

LINE_US = 12_000
"""Time of the longest line, its request, and both chips beside the move itself."""


def ar2_link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the joints on the robot's link of this name; RobotFileError where a cycle is too short."""
    table, axes = Ar2Link.of_link(robot, name), robot.axes_on(name)
    cycle = robot.cycle * table.every
    # A request and its answer have to fit in behind the move: the board takes no line until it ends.
    needed = table.move + (LINE_US + table.port_latency_us) * MICROSECOND
    if cycle < needed:
        problem = (
            f"a move of {table.move_ms} ms, and its messages, take {needed / MILLISECOND:.0f} ms, and "
            f"the link's cycle is {cycle // MILLISECOND} ms; give a shorter move_ms, or every"
        )
        raise RobotFileError(robot.name, Problem(f"links.{name}.move_ms", problem))
    board = Ar2Board(name, table)
    board.joints = tuple(Ar2Joint(axis, robot, board) for axis in axes)
    return LinkDrivers(board, table, board.joints)
