"""Since when the battery has been low; its interlock is in `common`."""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.drivers.driver import Reading
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds


class Charge:
    """One robot's battery, where it has one that is measured."""

    __slots__ = ("_battery", "_since")

    def __init__(self, robot: AnyRobot) -> None:
        self._battery: Final = robot.battery
        self._since: Nanoseconds | None = None

    def low_since(self, sensors: Mapping[str, Reading]) -> Nanoseconds | None:
        """Return when the first of the newest low readings was taken; None where the newest is not low."""
        reading = None if self._battery is None else sensors.get(self._battery.sensor)
        # A sensor that has gone silent starts the time again: only readings in a row count as low.
        if reading is None or self._battery is None or reading.value >= self._battery.low_v:
            self._since = None
        elif self._since is None:
            self._since = reading.sampled_at
        return self._since
