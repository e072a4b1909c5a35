"""Motion capture systems as a family of devices: they move nothing, and report where the robot is."""

from typing import Final

from firmware_bridge.dissector.mavlink import Mavlink
from firmware_bridge.dissector.protocols import Protocols
from firmware_bridge.families.motion_capture.check import check
from firmware_bridge.families.motion_capture.dissector import NatNet
from firmware_bridge.families.motion_capture.driver.link_drivers import capture_link_drivers
from firmware_bridge.families.motion_capture.guard import CaptureRules
from firmware_bridge.families.motion_capture.settings import CaptureBody, CaptureDriver, CaptureLink
from firmware_bridge.family import Family
from firmware_bridge.robot import AnyRobot


def _shown(robot: AnyRobot, name: str) -> str:
    link = CaptureLink.of_link(robot, name)
    return f"{name}: {link.driver.value} from {link.server}"


FAMILY: Final = Family(
    name="motion_capture",
    title="a motion capture system",
    link=CaptureLink,
    sensor=CaptureBody,
    check=check,
    link_drivers=capture_link_drivers,
    wire_rules=CaptureRules,
    protocols={
        CaptureDriver.NATNET: Protocols(NatNet),
        CaptureDriver.MAVLINK: Protocols(Mavlink),
    },
    shown=_shown,
)
