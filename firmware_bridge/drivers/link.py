"""The way between the bridge and its drives: how they are asked, how they know that the bridge lives.

What a method returns is to be sent. It refuses to know what a drive is told.
"""

from typing import Protocol

from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds


class Link(Protocol):
    """One robot's link to its drives."""

    name: str
    """The link whose packets it takes."""
    answers_within: Nanoseconds
    """How long after the begin of a cycle the drives' samples are waited for."""

    late: int
    """Cycles that began before the samples of the one before were in."""

    @property
    def lost(self) -> str | None:
        """Why no drive can be reached, in words; None while the link stands."""

    @property
    def wake_at(self) -> Nanoseconds:
        """When it wants to be woken, beside its drives."""

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Begin a cycle: have all drives tell where they are."""

    def beat(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Let the drives know that the bridge lives."""

    def hear(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a packet; what belongs to no drive is ignored."""

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
