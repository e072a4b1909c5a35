"""The guard's rules for a motion capture link: it moves nothing; only a listener's requests leave.

Received packets are the bridge's: they may be wrong, and their effect is judged on the links that move.
"""

from typing import Final

from firmware_bridge.families.motion_capture.settings import CaptureLink
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard.axisless import AxislessRules
from firmware_bridge.units import Nanoseconds

_HEAD: Final = 4
LISTENERS: Final = frozenset({0, 4, 10, 12})
"""Numbers of the NatNet messages connect, what is there, alive, what time is it."""


class CaptureRules(AxislessRules):
    """One link."""

    def __init__(self, robot: AnyRobot, link: str) -> None:
        super().__init__(link)
        self._server: Final = CaptureLink.all_of(robot)[link].server_number

    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Return why a packet may not leave: a wrong address, or more than a request to receive."""
        del now
        # The address is the destination of the datagram: any other one could reach any host on the network.
        if packet.address != self._server:
            return "it does not go to the capture system that the robot file names"
        if int.from_bytes(packet.payload[:2], "little") not in LISTENERS or len(packet.payload) < _HEAD:
            return "more than a listener may request of a capture system"
        return None
