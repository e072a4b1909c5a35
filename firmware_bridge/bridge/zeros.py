"""Where the axes stand, as whoever drives has seen it: the zero that follows, or why none does.

What was seen is taken disarmed, at rest, and within the axis's travel. The bridge makes up none of it.
"""

import math
from typing import Final, Generic, TypeVar

from firmware_bridge.bridge.fleets import Fleets
from firmware_bridge.drivers.driver import Driver, Power
from firmware_bridge.intent import ConfirmZero, Verdict
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Robot
from firmware_bridge.robot.table import Table
from firmware_bridge.teleop.station import Gauge
from firmware_bridge.units import MILLISECOND, Nanoseconds

G = TypeVar("G", bound=Table)

SLACK: Final = 1e-6
"""Share of its travel by which the end of an axis may be misread: conversions round."""


class Zeros(Generic[G]):
    """The axes of one robot whose zero somebody confirms."""

    def __init__(self, robot: Robot[G], gauges: tuple[Gauge[G], ...], fleets: Fleets) -> None:
        """Take what is read off the robot for which axis; of others it is the axis's own unit."""
        self._robot: Final = robot
        self._drivers: Final = {
            driver.axis.name: driver for driver in fleets.drivers if driver.axis.zero_confirmed
        }
        read = {gauge.role: gauge for gauge in gauges}
        self._gauges: Final = {
            name: read.get(driver.axis.role) or _own_unit(driver.axis)
            for name, driver in self._drivers.items()
        }

    def confirm(
        self, request: ConfirmZero, now: Nanoseconds, *, kept: str | None
    ) -> tuple[Verdict, tuple[Packet, ...]]:
        """Answer a request, and return what it sends; `kept` is why no axis may be given a zero now."""
        driver = self._drivers.get(request.axis)
        if driver is None:
            known = ", ".join(f"{name} ({gauge.unit})" for name, gauge in self._gauges.items()) or "none"
            return _refused(f"there is no {request.axis} to confirm; there is: {known}")
        gauge = self._gauges[request.axis]
        low, high = self._ends(driver.axis, gauge)
        if not low <= request.value <= high:
            seen = f"{request.value:.6g} {gauge.unit}"
            return _refused(f"{request.axis} at {seen} is not within {low:.4g} to {high:.4g}")
        reason = kept or self._keeps(driver, now)
        if reason is not None:
            return _refused(f"{request.axis}: {reason}", temporary=True)
        position = gauge.position(request.value, self._robot)
        sent = driver.set_zero(position, now)
        said = f"zero: {request.axis} stands at {request.value:.6g} {gauge.unit}"
        return Verdict(accepted=True, reason=said), sent

    def _ends(self, axis: Axis, gauge: Gauge[G]) -> tuple[float, float]:
        """Return the least and the most that can be read off the axis."""
        travel = axis.travel or (math.nan, math.nan)
        low, high = sorted(gauge.reading(end, self._robot) for end in travel)
        slack = SLACK * (high - low)
        return low - slack, high + slack

    def _keeps(self, driver: Driver, now: Nanoseconds) -> str | None:
        """Return why an axis may not be given a zero now."""
        axis, feedback = driver.axis, driver.feedback
        silent = now - feedback.heard_at >= self._robot.links[axis.link].silent_ms * MILLISECOND
        if driver.busy:
            return "its drive has something else to do; wait for it"
        if silent or not driver.configured or feedback.power is not Power.ON or feedback.fault:
            failed = "" if driver.failure is None else f" ({driver.failure.problem})"
            return f"its drive is not enabled{failed}; arm once, that enables it"
        if abs(feedback.velocity) > axis.rests_below:
            return "it moves"
        return None


def _own_unit(axis: Axis) -> Gauge[G]:
    unit = axis.unit.value
    return Gauge(axis.role, unit, _unchanged, _unchanged)


def _unchanged(value: float, _robot: Robot[G]) -> float:
    return value


def _refused(reason: str, *, temporary: bool = False) -> tuple[Verdict, tuple[Packet, ...]]:
    return Verdict(accepted=False, reason=f"zero: {reason}", temporary=temporary), ()
