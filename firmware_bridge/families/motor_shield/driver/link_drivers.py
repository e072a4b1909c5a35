"""A board with a motor shield as one link of the robot, and the same robot with another firmware on it."""

from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.motor_shield.driver.board import Board
from firmware_bridge.families.motor_shield.driver.dialects import DIALECTS
from firmware_bridge.families.motor_shield.driver.motor import ShieldMotor
from firmware_bridge.families.motor_shield.driver.plan import fitting_plan
from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink, ShieldProtocol
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.robot.problems import near


def shield_link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the motors on the robot's link of this name; PlanError where its cycle is too short."""
    plan, table, axes = fitting_plan(robot, name), ShieldLink.of_link(robot, name), robot.axes_on(name)
    dialect = DIALECTS[table.protocol](table, [ShieldAxis.of(axis) for axis in axes])
    board = Board(name, table, dialect, plan.answers_within)
    board.motors = tuple(ShieldMotor(axis, robot, board) for axis in axes)
    return LinkDrivers(board, table, board.motors)


def measured(robot: AnyRobot) -> AnyRobot:
    """Return this robot; RobotFileError where no one would know where it is, as too few encoders are read.

    Where cameras see it, the motors without one run on feed-forward, and the captured pose corrects them.
    """
    for name, link in ShieldLink.all_of(robot).items():
        # The encoders are counted by terminals: those beyond the firmware's number are not read.
        unseen = [axis.called for axis in robot.axes_on(name) if ShieldAxis.of(axis).port > link.counted]
        if unseen and robot.located_by is None:
            problem = (
                f"{link.protocol.value} reads {link.counted} encoders, and not that of {', '.join(unseen)}: "
                "without another source of its pose no one would know where the robot is; let cameras see "
                "it, or flash a firmware that reads all of them, and say --encoders"
            )
            raise RobotFileError(robot.name, Problem(f"links.{name}.encoders", problem))
    return robot


def over_protocol(robot: AnyRobot, protocol: str | None, encoders: int | None = None) -> AnyRobot:
    """Return this robot with another firmware on its boards, or another number of encoders that it reads.

    RobotFileError where it has no board, or no firmware is of that name.
    """
    if protocol is None and encoders is None:
        return robot
    known = [one.value for one in ShieldProtocol]
    if not ShieldLink.all_of(robot):
        raise RobotFileError(robot.name, Problem("links", "no motor shield is on any link"))
    if protocol is not None and protocol not in known:
        raise RobotFileError(robot.name, Problem("protocol", f"no '{protocol}'; {near(protocol, known)}"))
    for name, link in ShieldLink.all_of(robot).items():
        spoken = link.protocol if protocol is None else ShieldProtocol(protocol)
        motors = len(robot.axes_on(name))
        if spoken is ShieldProtocol.ROS_ARDUINO_BRIDGE and encoders not in {None, motors}:
            problem = f"{spoken.value} counts as many motors as it drives: {motors}"
            raise RobotFileError(robot.name, Problem("encoders", problem))
    return robot.with_links(
        {
            name: link.over(
                link.protocol if protocol is None else ShieldProtocol(protocol), robot.cycle_ms, encoders
            )
            for name, link in ShieldLink.all_of(robot).items()
        }
    )
