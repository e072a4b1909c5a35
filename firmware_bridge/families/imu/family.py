"""Inertial measurement units as a family of devices: they move nothing, and report how the robot stands."""

from typing import Final

from firmware_bridge.dissector.protocols import Protocols
from firmware_bridge.families.imu.dissector import ImuLine
from firmware_bridge.families.imu.driver.link_drivers import imu_link_drivers
from firmware_bridge.families.imu.guard import ImuRules
from firmware_bridge.families.imu.settings import ImuDriver, ImuLink, ImuSensor
from firmware_bridge.family import Family
from firmware_bridge.robot import AnyRobot


def _shown(robot: AnyRobot, name: str) -> str:
    link = ImuLink.of_link(robot, name)
    return f"{name}: {link.driver.value} at {link.rate} Bd"


FAMILY: Final = Family(
    name="imu",
    title="an IMU",
    link=ImuLink,
    sensor=ImuSensor,
    link_drivers=imu_link_drivers,
    wire_rules=ImuRules,
    protocols={ImuDriver.SERIAL: Protocols(ImuLine)},
    shown=_shown,
)
