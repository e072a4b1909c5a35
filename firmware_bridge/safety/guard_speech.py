"""What the guard must understand of a link: which words go to which axis, and what the safe words are."""

from abc import ABC, abstractmethod

from firmware_bridge.packet import Packet
from firmware_bridge.safety.guard_axis import GuardedAxis
from firmware_bridge.units import Nanoseconds


class Speech(ABC):
    """One robot's words on one link, and what the drives were last told by them."""

    link: str
    cycle: Nanoseconds
    axes: tuple[GuardedAxis, ...]

    @property
    @abstractmethod
    def speaking(self) -> bool:
        """Whether words of the guard itself still wait for the link."""

    @abstractmethod
    def axis_of(self, packet: Packet) -> GuardedAxis | None:
        """Return the axis whose set-point, or part of one, this is."""

    @abstractmethod
    def refuses(self, packet: Packet) -> str | None:
        """Return why a packet may not leave now, or None."""

    @abstractmethod
    def learn(self, packet: Packet) -> None:
        """Remember what an admitted packet does to the drives."""

    @abstractmethod
    def in_place_of(self, packet: Packet) -> tuple[Packet, ...]:
        """Return what leaves in the place of a refused packet."""

    @abstractmethod
    def safe(self, axis: GuardedAxis) -> tuple[Packet, ...]:
        """Return what takes motion away from an axis and changes nothing about its power."""

    @abstractmethod
    def leaves(self, packet: Packet, *, asked: bool) -> None:
        """Note a packet that leaves; `asked`: the node waits for what comes back."""

    @abstractmethod
    def passes(self, packet: Packet) -> bool:
        """Tell whether what comes in is the node's; each packet of the link is shown once."""
