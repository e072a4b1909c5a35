"""Positions of the axes as read off the robot by the station in control: their devices and values.

The permission to set a reference is decided elsewhere: by `permission`.
"""

import math
from collections.abc import Mapping
from typing import Final

from firmware_bridge.bridge.all_drivers import AllDrivers
from firmware_bridge.drivers.driver import Driver, Feedback
from firmware_bridge.intent import NEVER_RECEIVED, ConfirmPosition
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.teleop.station import AnyGauge, Gauge

DIGITS: Final = 9
"""Of what is read off the robot; conversions round."""
SLACK: Final = 1e-6
"""Share of its travel by which the end of an axis may be misread."""


class Zeros:
    """The axes of one robot whose positions need confirmation."""

    def __init__(self, robot: AnyRobot, gauges: tuple[AnyGauge, ...], all_drivers: AllDrivers) -> None:
        """Take what is read off the robot for which role; of others it is the axis's own unit."""
        self._robot: Final = robot
        self._drivers: Final = {
            driver.axis.name: driver for driver in all_drivers.drivers if driver.axis.needs_confirmation
        }
        read = {gauge.role: gauge for gauge in gauges}
        self._gauges: Final = {
            name: read.get(driver.axis.role) or _own_unit(driver.axis)
            for name, driver in self._drivers.items()
        }
        self._offered: Final[dict[str, float]] = {}
        """Positions of axes in an earlier run, as read off the robot."""
        self._positions: Final[dict[str, float]] = {}
        """Their positions in this one when they were last referenced, in their units."""

    @property
    def last(self) -> dict[str, float]:
        """Position of each axis when it was referenced, as read off the robot: an offer."""
        seen = {name: self._read(name, position) for name, position in self._positions.items()}
        return self._offered | seen

    def saw(self, axes: Mapping[str, Feedback]) -> dict[str, str]:
        """Note the positions of the referenced axes; of each other one return its last position as text."""
        lost = []
        for name in self._gauges:
            feedback = axes[name]
            if feedback.sampled_at != NEVER_RECEIVED and not feedback.reference_lost:
                self._positions[name] = feedback.position
            else:
                lost.append(name)
        last = self.last if lost else {}
        return {name: f"{last[name]:.4g} {self._gauges[name].unit}" for name in lost if name in last}

    def offer(self, last: Mapping[str, float]) -> None:
        """Take what an earlier run has kept of the axes that there are."""
        self._offered.update({name: place for name, place in last.items() if name in self._gauges})

    def refuses(self, request: ConfirmPosition) -> str | None:
        """Return why no one can mean a request, or None."""
        driver = self._drivers.get(request.axis)
        if driver is None:
            known = ", ".join(f"{name} ({gauge.unit})" for name, gauge in self._gauges.items()) or "none"
            return f"zero: no position to confirm for {request.axis}; to be confirmed: {known}"
        if math.isnan(request.value) and driver.axis.zero.homing is not None:
            return None
        gauge, ends = self._gauges[request.axis], driver.axis.travel or (math.nan, math.nan)
        low, high = sorted(self._read(request.axis, end) for end in ends)
        slack = SLACK * (high - low)
        if low - slack <= request.value <= high + slack:
            return None
        seen = f"{request.value:.6g} {gauge.unit}"
        blind = "; its robot file does not say how it is homed" if math.isnan(request.value) else ""
        return f"zero: {request.axis} at {seen} is not within {low:.4g} to {high:.4g}{blind}"

    def place(self, request: ConfirmPosition) -> tuple[Driver, float | None]:
        """Return the axis's device and its position in its unit, of a request that is not refused.

        None where it is to be homed.
        """
        if math.isnan(request.value):
            return self._drivers[request.axis], None
        position = self._gauges[request.axis].position(request.value, self._robot)
        return self._drivers[request.axis], position

    def _read(self, name: str, position: float) -> float:
        """Return a position as it is read off the robot."""
        # Adding 0 turns -0.0 into 0.0.
        return round(self._gauges[name].reading(position, self._robot), DIGITS) + 0.0


def _own_unit(axis: Axis) -> AnyGauge:
    return Gauge(axis.role, axis.unit.value, _unchanged, _unchanged)


def _unchanged(value: float, _robot: AnyRobot) -> float:
    return value
