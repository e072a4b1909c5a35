"""Who drives: one station at a time, and how control passes from one to the next.

It refuses to know what driving means, and sends nothing. Sources: common.xml, CHANGE_OPERATOR_CONTROL;
development.xml, MAV_CMD_REQUEST_OPERATOR_CONTROL, as QGroundControl and MAVProxy send it since 2026.
"""

from typing import Final, NamedTuple

from firmware_bridge.units import SECOND, Nanoseconds
from firmware_bridge.wire.internet import place_of

LAPSES_AFTER: Final[Nanoseconds] = 10 * SECOND
"""Who drives and says nothing for so long does not drive any more, once the robot rests."""


class Sender(NamedTuple):
    """Who speaks: where his datagrams come from, and his system and component."""

    source: int
    """The packet's address: what `firmware_bridge.wire.internet` makes of a place, or 0 on a link to one."""
    system: int
    component: int

    def __str__(self) -> str:
        place = place_of(self.source)
        return f"{self.system}/{self.component}" + (f" at {place}" if place else "")


class Control:
    """Who drives now; no one at first."""

    __slots__ = ("driver", "received_at", "turns", "yields")

    def __init__(self) -> None:
        self.driver: Sender | None = None
        self.turns = 0
        """How often someone has taken control who had it not."""
        self.yields = False
        """Whether the driver lets anybody take over who asks."""
        self.received_at: Nanoseconds = 0
        """When the driver was heard last, whatever he said."""

    def received(self, sender: Sender, now: Nanoseconds) -> None:
        """Take note of a good frame."""
        if sender == self.driver:
            self.received_at = now

    def refusal(self, sender: Sender) -> str | None:
        """Say why a station may not drive; None where it does, or no one does."""
        if self.driver is None or sender == self.driver:
            return None
        return f"{self.driver} is in control; request control, or wait until it is released"

    def take(self, sender: Sender, now: Nanoseconds, *, yields: bool = False) -> None:
        """Let a station drive."""
        self.turns += sender != self.driver
        self.driver, self.received_at, self.yields = sender, now, yields

    def give_up(self) -> None:
        """Let no one drive."""
        self.driver, self.yields = None, False

    def lapses(self, now: Nanoseconds) -> bool:
        """Return whether the driver has been silent for too long; the robot must rest before he loses it."""
        return self.driver is not None and now - self.received_at >= LAPSES_AFTER
