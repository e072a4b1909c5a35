"""A serial line as one link of the robot, and any robot of EPOS2 drives as it is reached over their ports."""

from collections.abc import Sequence

from firmware_bridge.drivers.epos2.inputs_outputs import inputs_of, outputs_of
from firmware_bridge.drivers.epos2.serial.drive import Epos2OnSerial
from firmware_bridge.drivers.epos2.serial.exchange import LineExchange
from firmware_bridge.drivers.epos2.serial.link import SerialLink
from firmware_bridge.drivers.epos2.serial.plan import fitting_plan
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.wire.maxon.frame import Generation


def serial_link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the devices on the robot's serial link of this name; PlanError where its cycle is too short."""
    plan, table, exchange = fitting_plan(robot, name), robot.epos2_link(name), LineExchange(name)
    drives = tuple(Epos2OnSerial(axis, robot, exchange) for axis in robot.axes_on(name))
    link = SerialLink(name, drives, exchange, table, plan.answers_within)
    return LinkDrivers(link, table, drives, inputs_of(robot, name, drives), outputs_of(robot, drives))


def over_serial(
    robot: AnyRobot,
    protocol: Generation | None = None,
    baud: int | None = None,
    gateway: int | None = None,
    links: Sequence[str] | None = None,
) -> AnyRobot:
    """Return this robot with these links, or all, over the serial port of one drive on each, the gateway.

    That is the first drive where neither the caller nor the file names one; what is not given stays the
    file's. RobotFileError where a link has no such drive, or no second one: then no one would stop the
    gateway when the line breaks.
    """
    changed = {}
    for name in robot.links if links is None else links:
        link = robot.epos2_link(name)
        nodes = robot.nodes_on(name)
        chosen = gateway or link.gateway or nodes[0]
        problem = (
            f"{chosen} is not the node of an axis on this link"
            if chosen not in nodes
            else "a drive without another one behind it watches no one"
        )
        if chosen not in nodes or len(nodes) == 1:
            raise RobotFileError(robot.name, Problem(f"links.{name}.gateway", problem))
        changed[name] = link.over_serial(chosen, protocol, baud)
    return robot.with_links(changed)
