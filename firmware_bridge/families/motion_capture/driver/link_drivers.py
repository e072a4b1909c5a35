"""The captured bodies on one link of the robot."""

from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.motion_capture.driver.body import SeenBody
from firmware_bridge.families.motion_capture.driver.mavlink import MavlinkPoses
from firmware_bridge.families.motion_capture.driver.natnet import NatNetLink
from firmware_bridge.families.motion_capture.settings import CaptureBody, CaptureDriver, CaptureLink
from firmware_bridge.robot import AnyRobot


def capture_link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the bodies on the robot's capture link of this name."""
    table = CaptureLink.all_of(robot)[name]
    bodies = tuple(
        SeenBody(sensor, sensor.settings)
        for sensor in robot.sensors
        if sensor.link == name and isinstance(sensor.settings, CaptureBody)
    )
    made = NatNetLink if table.driver is CaptureDriver.NATNET else MavlinkPoses
    return LinkDrivers(made(name, table, bodies), table, (), bodies)
