"""The guard's rules for an IMU's line: the bridge only listens there, so nothing leaves."""

from collections.abc import Mapping
from typing import Any

from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.safety.guard.wire_rules import WireRules
from firmware_bridge.units import Nanoseconds


class ImuRules(WireRules):
    """One line without axes."""

    axes: tuple[InForce, ...] = ()

    def __init__(self, robot: AnyRobot, link: str) -> None:
        del robot
        self.link = link

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
        """Return why a packet may not leave: none may."""
        del packet, now
        return "an IMU takes no command"

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
