"""The ground stations on record, and which of them is in control.

One station at a time is in control; while none is, each one's newest command counts. This module sends
nothing and knows no motion. Sources: common.xml, CHANGE_OPERATOR_CONTROL; development.xml,
MAV_CMD_REQUEST_OPERATOR_CONTROL, as QGroundControl and MAVProxy send it since 2026.
"""

from typing import Final

from firmware_bridge.mavlink.age import Ages
from firmware_bridge.teleop.incoming import Sender, Station
from firmware_bridge.teleop.texts import Quality
from firmware_bridge.units import SECOND, Nanoseconds

LAPSES_AFTER: Final[Nanoseconds] = 10 * SECOND
"""Silence after which a station loses control, once the robot is at standstill."""
MOST_STATIONS: Final = 64
"""Most stations on record; of more, the one silent for longest is dropped, never the one in control."""


class Stations:
    """All stations, and control of the robot; no station has it at first."""

    __slots__ = ("_by_key", "in_control", "of", "yields")

    def __init__(self, *, signed: bool) -> None:
        """Begin with none; `signed`: signatures are checked, so that their stamps are the stations'."""
        self._by_key: Final = signed
        self.of: Final[dict[Sender, Station]] = {}
        self.in_control: Station | None = None
        self.yields = False
        """True where the station in control lets any station take over on request."""

    @property
    def source(self) -> int | None:
        """The place of the station in control; None without one."""
        return None if self.in_control is None else self.in_control.sender.source

    def find(self, sender: Sender) -> Station:
        """Return the record of a sender, a new one where it has none."""
        station = self.of.get(sender)
        if station is None:
            if len(self.of) >= MOST_STATIONS:
                others = (one for one in self.of.values() if one is not self.in_control)
                del self.of[min(others, key=lambda one: one.received_at).sender]
            station = self.of[sender] = Station(sender)
        return station

    def passed(self, sender: Sender, sequence: int, now: Nanoseconds) -> None:
        """Note a frame for another robot: from the station in control it does not count as missing."""
        if self.in_control is not None and self.in_control.sender == sender:
            self.in_control.clocks.losses.received(sequence, now)

    def refusal(self) -> str:
        """Say why a station may not drive that is not in control, while another one is."""
        in_control = None if self.in_control is None else self.in_control.sender
        return f"{in_control} is in control; request control, or wait until it is released"

    def take(self, station: Station, *, yields: bool = False) -> None:
        """Let a station drive."""
        if station is not self.in_control:
            # Of another station's link nothing is known yet.
            station.clocks, station.quality = Ages(signed=self._by_key), Quality()
        self.in_control, self.yields = station, yields

    def give_up(self) -> None:
        """Let no one drive."""
        self.in_control, self.yields = None, False

    def lapses(self, now: Nanoseconds) -> bool:
        """Return whether the station in control has been silent for too long; the robot must rest first."""
        station = self.in_control
        return station is not None and now - station.received_at >= LAPSES_AFTER
