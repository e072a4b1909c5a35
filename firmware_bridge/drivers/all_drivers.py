"""The drivers of one robot, link by link, and what is known of its devices before; by their families."""

from firmware_bridge.drivers.driver import Reports
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.drivers.stop_stages import StopStage
from firmware_bridge.family import family_of
from firmware_bridge.robot import AnyRobot, Axis


def all_drivers_of(robot: AnyRobot) -> tuple[LinkDrivers, ...]:
    """Return the devices of each link, in the robot file's order; ValueError where a cycle does not fit."""
    return tuple(family_of(link).link_drivers(robot, name) for name, link in robot.links.items())


def reports_of(robot: AnyRobot, axis: Axis) -> frozenset[Reports]:
    """Return the reports of an axis' device."""
    return family_of(robot.links[axis.link]).reports(robot, axis)


def stop_stages_of(robot: AnyRobot, axis: Axis) -> tuple[StopStage, ...]:
    """Return the stop stages of an axis."""
    return family_of(robot.links[axis.link]).stop_stages(robot, axis)


def alone(robot: AnyRobot, link: str) -> str:
    """Return what stops the devices of a link without the bridge; empty where nothing does, or can move."""
    return family_of(robot.links[link]).alone(robot, link)
