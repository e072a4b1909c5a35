"""Axes whose set-points follow the position of another axis, between the cycles too.

A cycle samples all axes at one instant. Where the device of the leading axis sends its position in between,
the axes that it leads are commanded again then: by the motion that the interlocks have allowed in the cycle,
and never an axis whose newest set-point is a stop.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from firmware_bridge.bridge.all_drivers import AllDrivers
from firmware_bridge.drivers.driver import Feedback, SetPoint, Speed
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.units import MILLISECOND, Nanoseconds

EVERY: Final[Nanoseconds] = 5 * MILLISECOND
"""Least time between two commands: a device that sends without end must not fill the bus with answers."""


class LedAxes:
    """The axes of one robot that are led, and the newest position of those that lead."""

    def __init__(self, robot: AnyRobot, robot_type: AnyRobotType, all_drivers: AllDrivers) -> None:
        leading = {robot.axis(role).name for role in robot_type.led}
        self._leading: Final = tuple(driver for driver in all_drivers.drivers if driver.axis.name in leading)
        self._names: Final = frozenset(
            robot.axis(role).name for roles in robot_type.led.values() for role in roles
        )
        self._at: Nanoseconds = NEVER_RECEIVED
        """Arrival of the newest position that was followed."""

    def due(self, now: Nanoseconds) -> bool:
        """Return whether a position has come that was not followed, and the last one is long enough ago."""
        for driver in self._leading:
            between = driver.between
            if between is not None and between.at > self._at and now >= self._at + EVERY:
                return True
        return False

    def followed(self, now: Nanoseconds) -> None:
        """Note that the newest positions are followed now."""
        self._at = now

    def newest(self, axes: Mapping[str, Feedback]) -> Mapping[str, Feedback]:
        """Return the feedback with where the axes that lead will be; the same where none sends that."""
        newest: dict[str, Feedback] = {}
        for driver in self._leading:
            between, name = driver.between, driver.axis.name
            if between is not None and between.at >= axes[name].received_at:
                newest[name] = replace(axes[name], position=between.ahead)
        return {**axes, **newest} if newest else axes

    def of(self, set_points: Mapping[str, SetPoint], sent: Mapping[str, SetPoint]) -> dict[str, SetPoint]:
        """Return those set-points that may follow: of axes that are led, and whose newest one is a speed."""
        return {
            name: set_point
            for name, set_point in set_points.items()
            if name in self._names and isinstance(set_point, Speed) and isinstance(sent.get(name), Speed)
        }
