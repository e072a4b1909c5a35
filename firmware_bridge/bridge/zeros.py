"""Where the axes stand, as whoever drives has read it off the robot: for which device, and which position.

It refuses to know whether a zero may be set now: that is the permission's.
"""

import math
from typing import Final, Generic, TypeVar

from firmware_bridge.bridge.fleets import Fleets
from firmware_bridge.drivers.driver import Driver
from firmware_bridge.intent import ConfirmZero, Verdict
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

    def asked(self, request: ConfirmZero) -> tuple[Driver, float] | Verdict:
        """Return the axis's device and its position in its unit, or why nobody can mean it."""
        driver = self._drivers.get(request.axis)
        if driver is None:
            known = ", ".join(f"{name} ({gauge.unit})" for name, gauge in self._gauges.items()) or "none"
            return _refused(f"nobody has to tell where {request.axis} stands; to be told: {known}")
        gauge = self._gauges[request.axis]
        ends = driver.axis.travel or (math.nan, math.nan)
        low, high = sorted(round(gauge.reading(end, self._robot), DIGITS) + 0.0 for end in ends)
        slack = SLACK * (high - low)
        if not low - slack <= request.value <= high + slack:
            seen = f"{request.value:.6g} {gauge.unit}"
            return _refused(f"{request.axis} at {seen} is not within {low:.4g} to {high:.4g}")
        return driver, gauge.position(request.value, self._robot)


def _own_unit(axis: Axis) -> Gauge[G]:
    return Gauge(axis.role, axis.unit.value, _unchanged, _unchanged)


def _unchanged(value: float, _robot: Robot[G]) -> float:
    return value


def _refused(reason: str) -> Verdict:
    return Verdict(accepted=False, reason=f"zero: {reason}")
