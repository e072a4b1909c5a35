"""Where the axes stand, as whoever drives has read it off the robot: for which device, and which position.

It refuses to know whether a zero may be set now: that is the permission's.
"""

import math
from collections.abc import Mapping
from typing import Final, Generic, TypeVar

from firmware_bridge.bridge.fleets import Fleets
from firmware_bridge.drivers.driver import Driver, Feedback
from firmware_bridge.intent import NEVER_HEARD, ConfirmZero
from firmware_bridge.robot import Axis, Robot
from firmware_bridge.robot.table import Table
from firmware_bridge.teleop.station import Gauge

G = TypeVar("G", bound=Table)

DIGITS: Final = 9
"""Of what is read off the robot; conversions round."""
SLACK: Final = 1e-6
"""Share of its travel by which the end of an axis may be misread."""


class Zeros(Generic[G]):
    """The axes of one robot whose zero somebody confirms."""

    def __init__(self, robot: Robot[G], gauges: tuple[Gauge[G], ...], fleets: Fleets) -> None:
        """Take what is read off the robot for which role; of others it is the axis's own unit."""
        self._robot: Final = robot
        self._drivers: Final = {
            driver.axis.name: driver for driver in fleets.drivers if driver.axis.zero_confirmed
        }
        read = {gauge.role: gauge for gauge in gauges}
        self._gauges: Final = {
            name: read.get(driver.axis.role) or _own_unit(driver.axis)
            for name, driver in self._drivers.items()
        }

        self.last: dict[str, float] = {}
        """Where each axis was when its zero was known, as it is read off the robot: an offer."""

    def saw(self, axes: Mapping[str, Feedback]) -> dict[str, str]:
        """Note where the axes are whose zero is known; return in words where each was last."""
        for name, gauge in self._gauges.items():
            feedback = axes[name]
            if feedback.sampled_at != NEVER_HEARD and not feedback.zero_lost:
                self.last[name] = round(gauge.reading(feedback.position, self._robot), DIGITS) + 0.0
        return {name: f"{place:.4g} {self._gauges[name].unit}" for name, place in self.last.items()}

    def offer(self, last: Mapping[str, float]) -> None:
        """Take what an earlier run has kept of the axes that there are."""
        self.last.update({name: place for name, place in last.items() if name in self._gauges})

    def refuses(self, request: ConfirmZero) -> str | None:
        """Return why nobody can mean a request, or None."""
        driver = self._drivers.get(request.axis)
        if driver is None:
            known = ", ".join(f"{name} ({gauge.unit})" for name, gauge in self._gauges.items()) or "none"
            return f"zero: nobody has to tell where {request.axis} stands; to be told: {known}"
        if math.isnan(request.value) and driver.axis.zero.homing is not None:
            return None
        gauge, ends = self._gauges[request.axis], driver.axis.travel or (math.nan, math.nan)
        low, high = sorted(round(gauge.reading(end, self._robot), DIGITS) + 0.0 for end in ends)
        slack = SLACK * (high - low)
        if low - slack <= request.value <= high + slack:
            return None
        seen = f"{request.value:.6g} {gauge.unit}"
        blind = "; its robot file does not say how it is homed" if math.isnan(request.value) else ""
        return f"zero: {request.axis} at {seen} is not within {low:.4g} to {high:.4g}{blind}"

    def place(self, request: ConfirmZero) -> tuple[Driver, float | None]:
        """Return the axis's device and its position in its unit, of a request that is not refused.

        None where it is to be homed.
        """
        if math.isnan(request.value):
            return self._drivers[request.axis], None
        position = self._gauges[request.axis].position(request.value, self._robot)
        return self._drivers[request.axis], position


def _own_unit(axis: Axis) -> Gauge[G]:
    return Gauge(axis.role, axis.unit.value, _unchanged, _unchanged)


def _unchanged(value: float, _robot: Robot[G]) -> float:
    return value
