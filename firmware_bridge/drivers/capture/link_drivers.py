"""The captured bodies on one link of the robot."""

from firmware_bridge.drivers.capture.body import SeenBody
from firmware_bridge.drivers.capture.mavlink import MavlinkPoses
from firmware_bridge.drivers.capture.natnet import NatNetLink
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.settings.capture import CaptureBody, CaptureDriver, CaptureLink


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
