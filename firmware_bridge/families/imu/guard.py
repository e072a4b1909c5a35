"""The guard's rules for an IMU's line: the bridge only listens there, so nothing leaves."""

from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard.axisless import AxislessRules
from firmware_bridge.units import Nanoseconds


class ImuRules(AxislessRules):
    """One line."""

    def __init__(self, robot: AnyRobot, link: str) -> None:
        del robot
        super().__init__(link)

    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Return why a packet may not leave: none may."""
        del packet, now
        return "an IMU takes no command"
