"""Plausibility of the payload: what RARS weighs, by its motors' currents and the IMU.

By Newton F = M s + R: F is the driving motors' force on the floor, by their currents; s the specific force
ahead, which an accelerometer on the robot measures whether it climbs or speeds up; R what it needs on the
level. M is the least squares' over the newest seconds in which it drove and s was not small. The gears' and
tyres' losses are in R only roughly, so a load is found that is far above what is stated, and no small one.
"""

import math
from collections.abc import Mapping
from typing import Final

from firmware_bridge.drivers.driver import Feedback, Reading
from firmware_bridge.robots.rars.geometry import Weighing
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, to_seconds

DRIVES_MPS: Final = 0.05
"""Slower ones do not count: friction at rest has any size."""
STRONG_MPS2: Final = 1.0
"""Least specific force ahead that counts: that of a slope of 6 degrees."""
REMEMBERS_S: Final = 5.0
LASTS_S: Final = 2.5
"""Time of measurements, the older ones by less, without which nothing is known."""
LONGEST: Final[Nanoseconds] = 500 * MILLISECOND
"""A measurement stands for no longer time."""
FORGETS: Final[Nanoseconds] = SECOND
"""Standing for so long it forgets: it may have been loaded, or unloaded."""


class Weigher:
    """The estimate of one robot's mass."""

    def __init__(self, table: Weighing, left: str, right: str) -> None:
        self._table: Final = table
        self._axes: Final = (left, right)
        self._at: Nanoseconds = -NEVER
        self._drove_at: Nanoseconds = -NEVER
        self._seconds = self._forces = self._squares = 0.0

    @property
    def mass_kg(self) -> float | None:
        """The mass with its load; None while too little was measured."""
        return self._forces / self._squares if self._seconds >= LASTS_S else None

    def take(self, axes: Mapping[str, Feedback], sensors: Mapping[str, Reading], speed_mps: float) -> None:
        """Take the newest currents, once each, with the newest specific force."""
        at = min(axes[name].current_at for name in self._axes)
        if at <= self._at:
            return
        passed, self._at = min(at - self._at, LONGEST), at
        if abs(speed_mps) < DRIVES_MPS:
            if at - self._drove_at > FORGETS:
                self._seconds = self._forces = self._squares = 0.0
            return
        self._drove_at = at
        reading = sensors.get(self._table.acceleration)
        currents = [axes[name].current_a for name in self._axes]
        # Written so that NaN does not count.
        if reading is None or not STRONG_MPS2 < abs(reading.value) < math.inf:
            return
        amperes = sum(one for one in currents if one is not None)
        if None in currents or not math.isfinite(amperes):
            return
        force = self._table.newton_per_ampere * amperes - math.copysign(self._table.resistance_n, speed_mps)
        elapsed = to_seconds(passed)
        kept = math.exp(-elapsed / REMEMBERS_S)
        self._seconds = kept * self._seconds + elapsed
        self._forces = kept * self._forces + elapsed * force * reading.value
        self._squares = kept * self._squares + elapsed * reading.value**2
