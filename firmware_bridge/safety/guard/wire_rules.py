"""What the guard must know of a link: which packets may leave, what they put in force, and the safe ones."""

from abc import ABC, abstractmethod

from firmware_bridge.packet import Packet
from firmware_bridge.safety.guard.axis import GuardedAxis
from firmware_bridge.safety.guard.epos2_words import SetPoint
from firmware_bridge.units import Nanoseconds


class WireRules(ABC):
    """One protocol's rules for the drives of one link, and what was sent to them and reported by them."""

    link: str
    axes: tuple[GuardedAxis, ...]

    @property
    @abstractmethod
    def waiting(self) -> bool:
        """Whether words of the guard itself still wait for the link."""

    @abstractmethod
    def axis_of(self, packet: Packet) -> GuardedAxis | None:
        """Return the axis whose set-point, or part of one, this is."""

    @abstractmethod
    def set_point_of(self, packet: Packet, axis: GuardedAxis) -> SetPoint:
        """Return what an axis's packet, which is not refused, would put in force."""

    @abstractmethod
    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Return why a packet may not leave now, or None."""

    @abstractmethod
    def safe(self, axis: GuardedAxis) -> tuple[Packet, ...]:
        """Return what takes motion away from an axis and gives it no power."""

    @abstractmethod
    def instead_of(self, packet: Packet) -> tuple[Packet, ...] | None:
        """Return what leaves instead of a refused packet that is no set-point; None to stop every axis."""

    @abstractmethod
    def sends(self, packet: Packet, now: Nanoseconds, *, asked: bool) -> GuardedAxis | None:
        """Note a packet that leaves; return the axis for which it put something in force.

        `asked`: the node waits for what comes back.
        """

    @abstractmethod
    def receives(self, packet: Packet, now: Nanoseconds) -> bool:
        """Note what comes in, and tell whether it is the node's; each packet of the link is shown once."""
