"""The quantities of the IMU on one link of the robot."""

from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.imu.driver.link import ImuLine
from firmware_bridge.families.imu.driver.sensor import ImuQuantity
from firmware_bridge.families.imu.settings import ImuLink, ImuSensor
from firmware_bridge.robot import AnyRobot


def imu_link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the quantities on the robot's link of this name."""
    table = ImuLink.of_link(robot, name)
    quantities = tuple(
        ImuQuantity(sensor, sensor.settings)
        for sensor in robot.sensors
        if sensor.link == name and isinstance(sensor.settings, ImuSensor)
    )
    return LinkDrivers(ImuLine(name, table, quantities), table, (), quantities)
