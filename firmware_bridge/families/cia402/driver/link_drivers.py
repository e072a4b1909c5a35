"""Drives of any maker on a CAN bus as one link of the robot."""

from typing import Final

from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.driver.can_drive import DriveOnCan
from firmware_bridge.canopen_drive.driver.can_link import CanLink
from firmware_bridge.canopen_drive.driver.object_sensor import MeasuredObject, ObjectSensor
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.cia402.driver.product import configuration, product
from firmware_bridge.families.cia402.settings import Cia402Link, Cia402Supply
from firmware_bridge.families.cia402.wire.address import SUPPLY
from firmware_bridge.robot import AnyRobot

VOLTAGE: Final = MeasuredObject(SUPPLY, DataType.UNSIGNED32, 1.0, 1000.0)
"""The DC link circuit voltage, in mV."""


def link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the devices on the robot's link of this name."""
    table = Cia402Link.of_link(robot, name)
    drives = tuple(
        DriveOnCan(axis, product(axis), configuration(axis, robot)) for axis in robot.axes_on(name)
    )
    by_axis = {drive.axis.name: drive for drive in drives}
    sensors = tuple(
        ObjectSensor(sensor, by_axis[Cia402Supply.of(sensor).axis], VOLTAGE)
        for sensor in robot.sensors
        if sensor.link == name
    )
    return LinkDrivers(CanLink(name, drives, table), table, drives, sensors)
