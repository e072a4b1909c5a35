"""The guard's rules for a link without axes: nothing on it moves; what may leave is the family's own rule."""

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any

from firmware_bridge.packet import Packet
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.safety.guard.wire_rules import WireRules
from firmware_bridge.units import Nanoseconds


class AxislessRules(WireRules):
    """One link without axes."""

    axes: tuple[InForce, ...] = ()

    def __init__(self, link: str) -> None:
        self.link = link

    @abstractmethod
    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Return why a packet may not leave; None where it may."""

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
