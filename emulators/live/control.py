"""Control of the robot for the live page: taken from the mission's operator, and a stop that always stops."""

from typing import Final

from emulators.live.page_station import COMPONENT, SYSTEM, PageStation
from emulators.paced import OutsideOperator
from emulators.rig import OPERATOR_STATION, Rig
from firmware_bridge.node import Node
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

AGAIN: Final[Nanoseconds] = 200 * MILLISECOND
"""A request that was lost on the link is sent again."""
STOPS_WITHIN: Final[Nanoseconds] = SECOND
"""A page that has no control then stops the robot by an emergency stop, which any station may."""


class PageControl:
    """Who is in control, as far as the page wants it."""

    def __init__(self, rig: Rig, station: PageStation, operator: Node | None) -> None:
        """Take the bench, the page's station, and the operator: a mission's lets go, one outside need not."""
        self._rig: Final = rig
        self._station: Final = station
        self._yields: Final = not isinstance(operator, OutsideOperator)
        self._wanted = False
        self._due: Nanoseconds = NEVER
        self._stops_by: Nanoseconds = NEVER

    @property
    def has(self) -> bool:
        """True while the page's station is in control."""
        station = self._rig.bridge.operator.stations.in_control
        return station is not None and station.sender[1:] == (SYSTEM, COMPONENT)

    def take(self, *, on: bool) -> None:
        """Take control, or release it."""
        self._wanted = on
        self._due = self._rig.world.now if on else NEVER
        if not on:
            self._station.orders("take_control", on=False)
            self._silence(NEVER)

    def stop(self) -> None:
        """Stop the robot: pause it, as who is in control may, else by an emergency stop."""
        self.take(on=True)
        self._stops_by = self._rig.world.now + STOPS_WITHIN

    def forget(self) -> None:
        """Want nothing any more: time was put back."""
        self._wanted, self._due, self._stops_by = False, NEVER, NEVER

    def turn(self) -> bool:
        """Go on with what is wanted; return whether the station has something to send."""
        now, stops = self._rig.world.now, self._stops_by != NEVER
        if self.has:
            self._due = NEVER
            if stops:
                self._stops_by = NEVER
                self._station.orders("stop")
            return stops
        if now >= self._stops_by:
            self._stops_by = NEVER
            self._station.orders("emergency_stop")
            return True
        if self._wanted and now >= self._due:
            self._due = now + AGAIN
            self._request()
            return True
        return False

    def _request(self) -> None:
        holder = self._rig.bridge.operator.stations.in_control
        if holder is not None and self._yields:
            self._station.releases_for(holder.sender.system, holder.sender.component, holder.sender.source)
            self._silence(self._rig.world.now)
        self._station.orders("take_control")

    def _silence(self, since: Nanoseconds) -> None:
        """Let the mission's operator send nothing from then on; NEVER: let it speak again."""
        if self._yields and self._rig.world.here(OPERATOR_STATION):
            self._rig.world.silence(OPERATOR_STATION, since)
