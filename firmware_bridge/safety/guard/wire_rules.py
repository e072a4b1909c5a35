"""The guard's view of a link: the permitted packets, the set-points they put in force, the safe ones."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Final

from firmware_bridge.extensible import extensible
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.units import Nanoseconds

ROUNDING: Final = 1e-12
"""Share of a bound by which its conversion may fall short: 4000 rpm must not become 3999."""


@extensible(allow_interpreted_subclasses=True)
class WireRules(ABC):
    """One protocol's rules for the drives of one link, and what was sent to them and reported by them."""

    link: str
    axes: tuple[InForce, ...]

    @property
    def waiting(self) -> bool:
        """True while commands of the guard itself still wait for the link; here each leaves at once."""
        return False

    def permitted(self, axis: Axis) -> str:
        """Describe the targets that an axis of the link may be sent, for people; empty: not described."""
        del axis
        return ""

    @abstractmethod
    def axes_of(self, packet: Packet) -> tuple[InForce, ...]:
        """Return the axes whose set-points, or parts of them, this is."""

    @abstractmethod
    def requested_by(self, packet: Packet) -> Mapping[InForce, RequestedMotion]:
        """Return what such a packet, which is not refused, would have its axes do."""

    @abstractmethod
    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Return why a packet may not leave now, or None."""

    @abstractmethod
    def safe(self, axis: Any) -> tuple[Packet, ...]:
        """Return what takes motion away from one of the link's own axes and gives it no power."""

    def replacement_of(self, packet: Packet) -> tuple[Packet, ...] | None:
        """Return what leaves instead of a refused packet that is no set-point; None to stop every axis."""
        del packet
        return None

    @abstractmethod
    def sends(self, packet: Packet, now: Nanoseconds, *, requested: bool) -> tuple[InForce, ...]:
        """Note a packet that leaves; return the axes for which it put something in force.

        `requested`: the node waits for what comes back.
        """

    def receives(self, packet: Packet, now: Nanoseconds) -> bool:
        """Note a received packet, once for each packet of the link; return whether it is the node's."""
        del packet, now
        return True
