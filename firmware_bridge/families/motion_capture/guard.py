"""The guard's rules for a motion capture link: it moves nothing; only a listener's requests leave.

Received packets are the bridge's: they may be wrong, and their effect is judged on the links that move.
"""

from collections.abc import Mapping
from typing import Any, Final

from firmware_bridge.families.motion_capture.settings import CaptureLink
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.safety.guard.wire_rules import WireRules
from firmware_bridge.units import Nanoseconds

_HEAD: Final = 4
LISTENERS: Final = frozenset({0, 4, 10, 12})
"""Numbers of the NatNet messages connect, what is there, alive, what time is it."""


class CaptureRules(WireRules):
    """One link without axes."""

    axes: tuple[InForce, ...] = ()

    def __init__(self, robot: AnyRobot, link: str) -> None:
        self.link = link
        self._server: Final = CaptureLink.all_of(robot)[link].server_number

    @property
    def waiting(self) -> bool:
        """Always False: the guard sends nothing here."""
        return False

    def axes_of(self, packet: Packet) -> tuple[InForce, ...]:
        """Return none."""
        del packet
        return ()

    def requested_by(self, packet: Packet) -> Mapping[InForce, RequestedMotion]:
        """Return nothing."""
        del packet
        return {}

    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Return why a packet may not leave: a wrong address, or more than a request to receive."""
        del now
        # The address is the destination of the datagram: any other one could reach any host on the network.
        if packet.address != self._server:
            return "it does not go to the capture system that the robot file names"
        if int.from_bytes(packet.payload[:2], "little") not in LISTENERS or len(packet.payload) < _HEAD:
            return "more than a listener may request of a capture system"
        return None

    def safe(self, axis: Any) -> tuple[Packet, ...]:
        """Return nothing."""
        del axis
        return ()

    def replacement_of(self, packet: Packet) -> tuple[Packet, ...] | None:
        """Return nothing: no axis need stop for it."""
        del packet
        return ()

    def sends(self, packet: Packet, now: Nanoseconds, *, requested: bool) -> tuple[InForce, ...]:
        """Note nothing."""
        del packet, now, requested
        return ()

    def receives(self, packet: Packet, now: Nanoseconds) -> bool:
        """Let it through."""
        del packet, now
        return True
