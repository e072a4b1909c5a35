"""EPOS2 drives on a CAN bus as one link of the robot."""

from firmware_bridge.canopen_drive.driver.can_drive import DriveOnCan
from firmware_bridge.canopen_drive.driver.can_link import CanLink
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.epos2.driver.inputs_outputs import inputs_of, outputs_at, outputs_of
from firmware_bridge.families.epos2.driver.product import configuration, product
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.robot import AnyRobot


def can_link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the devices on the robot's CAN link of this name."""
    table = Epos2Link.of_link(robot, name)
    drives = tuple(
        DriveOnCan(axis, product(axis), configuration(axis, table, outputs_at(robot, axis)))
        for axis in robot.axes_on(name)
    )
    link = CanLink(name, drives, table)
    return LinkDrivers(link, table, drives, inputs_of(robot, name, drives), outputs_of(robot, drives))
