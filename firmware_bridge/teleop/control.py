"""The station in control: one at a time, and how control passes from one to the next.

This module sends nothing and knows no motion. Sources: common.xml, CHANGE_OPERATOR_CONTROL; development.xml,
MAV_CMD_REQUEST_OPERATOR_CONTROL, as QGroundControl and MAVProxy send it since 2026.
"""

from typing import Final, NamedTuple

from firmware_bridge.units import SECOND, Nanoseconds
from firmware_bridge.wire.internet import place_of

LAPSES_AFTER: Final[Nanoseconds] = 10 * SECOND
"""Silence after which a station loses control, once the robot is at standstill."""


class Sender(NamedTuple):
    """A sender: the source of its datagrams, and its system and component."""

    source: int
    """The packet's address: what `firmware_bridge.wire.internet` makes of a place, or 0 on a link to one."""
    system: int
    component: int

    def __str__(self) -> str:
        place = place_of(self.source)
        return f"{self.system}/{self.component}" + (f" at {place}" if place else "")


class StationInControl:
    """Control of the robot; no station has it at first."""

    __slots__ = ("driver", "received_at", "turns", "yields")

    def __init__(self) -> None:
        self.driver: Sender | None = None
        self.turns = 0
        """Count of takeovers by a station without control."""
        self.yields = False
        """True where the station in control lets any station take over on request."""
        self.received_at: Nanoseconds = 0
        """Time of the newest frame of the station in control, whatever it is."""

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
