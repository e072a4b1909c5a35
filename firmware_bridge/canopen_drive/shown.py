"""A CAN bus of drives in the picture of a robot's links."""

from firmware_bridge.canopen_drive.settings import DriveLink
from firmware_bridge.robot import AnyRobot


def shown(robot: AnyRobot, name: str) -> str:
    """Return driver, rate and cycle of a link, in lines."""
    link = DriveLink.of_link(robot, name)
    every = f"every {link.every * robot.cycle_ms} ms"
    return f"{name}: {link.driver.value}, {link.bit_rate // 1000} kbit/s\n{every}"
