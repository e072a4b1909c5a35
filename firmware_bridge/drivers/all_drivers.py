"""The drivers of one robot, link by link: the one place that knows which kinds of drivers there are."""

from collections.abc import Callable, Mapping
from typing import Final

from firmware_bridge.drivers.ar2 import link_drivers as ar2
from firmware_bridge.drivers.ar2 import stops as ar2_stops
from firmware_bridge.drivers.capture.link_drivers import capture_link_drivers
from firmware_bridge.drivers.driver import Reports
from firmware_bridge.drivers.epos2 import feedback as epos2
from firmware_bridge.drivers.epos2 import stops as epos2_stops
from firmware_bridge.drivers.epos2.can.link_drivers import can_link_drivers
from firmware_bridge.drivers.epos2.serial.link_drivers import serial_link_drivers
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.drivers.shield import motor as shield
from firmware_bridge.drivers.shield import stops as shield_stops
from firmware_bridge.drivers.shield.link_drivers import shield_link_drivers
from firmware_bridge.drivers.stop_stages import StopStage
from firmware_bridge.robot import AnyLink, AnyRobot, Axis
from firmware_bridge.robot.settings.ar2 import Ar2Driver
from firmware_bridge.robot.settings.capture import CaptureDriver
from firmware_bridge.robot.settings.epos2 import Epos2Driver
from firmware_bridge.robot.settings.shield import ShieldDriver

DRIVERS: Final[Mapping[str, Callable[[AnyRobot, str], LinkDrivers]]] = {
    Epos2Driver.CAN: can_link_drivers,
    Epos2Driver.SERIAL: serial_link_drivers,
    ShieldDriver.MOTOR_SHIELD: shield_link_drivers,
    Ar2Driver.AR2: ar2.ar2_link_drivers,
    **dict.fromkeys(CaptureDriver, capture_link_drivers),
}
"""Makers of a link's devices, by the driver that the robot file names."""

REPORTS: Final[Mapping[str, Callable[[Axis, AnyLink], frozenset[Reports]]]] = {
    **dict.fromkeys(Epos2Driver, lambda _axis, _link: epos2.REPORTS),
    ShieldDriver.MOTOR_SHIELD: shield.reports,
    Ar2Driver.AR2: ar2.reports,
}
"""Reports of an axis' device, by the driver of its link, before there is one."""

STOP_STAGES: Final[Mapping[str, Callable[[AnyRobot, Axis], tuple[StopStage, ...]]]] = {
    **dict.fromkeys(Epos2Driver, epos2_stops.stop_stages),
    ShieldDriver.MOTOR_SHIELD: shield_stops.stop_stages,
    Ar2Driver.AR2: ar2_stops.stop_stages,
}
"""The stop stages of a robot's axis, by the driver of its link."""

CONFIRMED_BY: Final[Mapping[str, str]] = {
    **dict.fromkeys(Epos2Driver, epos2_stops.CONFIRMED_BY),
    ShieldDriver.MOTOR_SHIELD: shield_stops.CONFIRMED_BY,
    Ar2Driver.AR2: ar2_stops.CONFIRMED_BY,
}
"""The device's report that confirms a stop, by the driver of its link, as text."""

ALONE: Final[Mapping[str, Callable[[AnyRobot, str], str]]] = {
    **dict.fromkeys(Epos2Driver, epos2_stops.alone),
    ShieldDriver.MOTOR_SHIELD: shield_stops.alone,
    Ar2Driver.AR2: ar2_stops.alone,
}
"""The devices' own stop when the bridge falls silent, by the driver, as text; empty where there is none."""


def alone(robot: AnyRobot, link: str) -> str:
    """Return what stops the devices of a link without the bridge; empty where nothing does, or can move."""
    only = ALONE.get(robot.links[link].driver)
    return "" if only is None else only(robot, link)


def reports_of(robot: AnyRobot, axis: Axis) -> frozenset[Reports]:
    """Return the reports of an axis' device."""
    link = robot.links[axis.link]
    return REPORTS[link.driver](axis, link)


def all_drivers_of(robot: AnyRobot) -> tuple[LinkDrivers, ...]:
    """Return the devices of each link, in the robot file's order; PlanError where a cycle does not fit."""
    return tuple(DRIVERS[link.driver](robot, name) for name, link in robot.links.items())
