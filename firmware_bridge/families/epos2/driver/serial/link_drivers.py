"""A serial line as one link of the robot, and any robot of EPOS2 drives as it is reached over their ports."""

from collections.abc import Sequence
from typing import Final

from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.epos2.driver.inputs_outputs import inputs_of, outputs_of
from firmware_bridge.families.epos2.driver.serial.drive import Epos2OnSerial
from firmware_bridge.families.epos2.driver.serial.exchange import LineExchange
from firmware_bridge.families.epos2.driver.serial.link import SerialLink
from firmware_bridge.families.epos2.driver.serial.plan import fitting_plan
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.settings import Epos2Driver, Epos2Link, nodes_on
from firmware_bridge.family import LinkOptions
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError

OPTIONS: Final = frozenset({"protocol", "baud"})
"""Options of a command that a serial line takes."""


def serial_link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the devices on the robot's serial link of this name; PlanError where its cycle is too short."""
    plan, table, exchange = fitting_plan(robot, name), Epos2Link.of_link(robot, name), LineExchange(name)
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
    for name in Epos2Link.all_of(robot) if links is None else links:
        link = Epos2Link.of_link(robot, name)
        nodes = nodes_on(robot, name)
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


def with_options(robot: AnyRobot, options: LinkOptions) -> AnyRobot:
    """Return this robot with its links by a command's options; RobotFileError where they do not suit."""
    links = Epos2Link.all_of(robot)
    known = [one.value for one in Generation]
    if options.protocol is not None and options.protocol not in known:
        problem = f"drives speak {' or '.join(known)}, not '{options.protocol}'"
        raise RobotFileError(robot.name, Problem("protocol", problem))
    on_lines = [name for name in options.lines if name in links]
    serial = any(link.driver is Epos2Driver.SERIAL for link in links.values())
    if on_lines or serial:
        protocol = None if options.protocol is None else Generation(options.protocol)
        return over_serial(robot, protocol, options.baud, links=on_lines or None)
    if given := sorted(options.given & OPTIONS):
        problem = "is of a serial port; name it with --serial DEVICE"
        raise RobotFileError(robot.name, *(Problem(f"--{option}", problem) for option in given))
    return robot
