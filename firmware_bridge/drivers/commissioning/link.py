"""What a client asks of a link: take one errand, hear and send packets for it, give back its outcome."""

from typing import Protocol

from firmware_bridge.drivers.commissioning.errand import Errand, Outcome
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds

Sent = tuple[Packet, ...]


class DriveLink(Protocol):
    """The way to one drive, one errand at a time."""

    @property
    def wake_at(self) -> Nanoseconds:
        """When to call `wake`; `NEVER` while nothing is under way."""

    def begin(self, errand: Errand, now: Nanoseconds) -> Sent:
        """Begin an errand, and return what to send."""

    def hear(self, packet: Packet, now: Nanoseconds) -> Sent:
        """Take a packet, whosever it is, and return what to send."""

    def wake(self, now: Nanoseconds) -> Sent:
        """Act on the time, and return what to send."""

    def take(self) -> Outcome | None:
        """Return how the errand ended, once; None while it has not."""
