"""RARS's governor: speed, acceleration, turns and lift by the margin of the zero-moment point (thesis 2.3.1).

It needs the table `geometry.balance` of the robot file, and an IMU; without them it changes nothing. Lift and
drive may both want what the robot cannot stand: each row of `firmware_bridge.robots.rars.rules` gets its part
here.
"""

import math
from collections.abc import Mapping
from typing import Final

from firmware_bridge.drivers.driver import Reading
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.motion.standing import Corner, Standing
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.motion import RarsState
from firmware_bridge.units import STANDARD_GRAVITY

SAFE_SHARE: Final = 0.9
"""Share of the safe speed that is driven: 0.5 m/s overshoot to 0.55 on the plant, on 25 degrees, 10 kg."""
BRAKES: Final = 0.03 * STANDARD_GRAVITY
"""Braking that is allowed where the wheels stay loaded without any margin, m/s2."""
SLIPS: Final = 0.6
"""Share of the deceleration that takes all margin: wheels that slip downhill stop harder than commanded."""
LEAST_BRAKES: Final = 0.01 * STANDARD_GRAVITY
"""Braking that is always allowed, m/s2: at the safe speed not even a stop at once tips the robot over."""
STARTS: Final = 0.01 * STANDARD_GRAVITY
"""A direction in which the robot may not accelerate with so much, m/s2, is not driven in."""
HOLDS: Final = 1.15
"""The floor's friction by what holds the robot at least: the tilt's error is in it, and a load put on."""
STEEPEST_RAD: Final = math.radians(60.0)
"""A tilt beyond it is no floor that it drives on."""


class Governor:
    """The margins of one robot."""

    def __init__(self, geometry: RarsGeometry) -> None:
        self._base: Final = geometry.base
        self._balance: Final = geometry.balance
        half_rear, half_front = geometry.base.rear_track_m / 2.0, geometry.base.half_support_width_m
        ahead = geometry.base.wheelbase_m
        self._corners: Final[tuple[Corner, ...]] = (
            (0.0, -half_rear),
            (ahead, -half_front),
            (ahead, half_front),
            (0.0, half_rear),
        )

    def tilt(self, sensors: Mapping[str, Reading]) -> tuple[float, float] | None:
        """Return pitch and roll in rad; None where one of them is unknown."""
        if self._balance is None:
            return None
        readings = [sensors.get(name) for name in (self._balance.pitch, self._balance.roll)]
        values = [one.value for one in readings if one is not None]
        # Written so that NaN is unknown.
        if len(values) < len(readings) or not all(abs(value) <= STEEPEST_RAD for value in values):
            return None
        return values[0], values[1]

    def margin(self, lift_m: float | None, tilt_rad: tuple[float, float] | None) -> float | None:
        """Return the margin in m at standstill, as measured; None where it is unknown."""
        standing = self._standing(lift_m, tilt_rad)
        return None if standing is None else standing.margin()

    def ramped(
        self, before: float, speed: float, state: RarsState, bend_per_m: float, seconds: float
    ) -> float:
        """Return the speed of a ramp, in m/s, within the accelerations that keep the wheels loaded."""
        standing, balance = self._standing(state.lift_m, state.tilt_rad), self._balance
        if standing is None or balance is None or speed == before:
            return speed
        left = before * before * bend_per_m
        low, high = standing.accelerations(left, balance.needed(standing.height_m))
        slower, faster = (low, high) if before >= 0.0 else (-high, -low)
        sign = 1.0 if before >= 0.0 else -1.0
        # Seen along the way of travel: it may always brake, and speed up only where the margin allows it.
        slower, faster = min(MARGIN * slower, -self._brakes(standing, left, sign)), max(MARGIN * faster, 0.0)
        change = min(max(sign * (speed - before), slower * seconds), faster * seconds)
        if before == 0.0 and speed < 0.0:
            # From standstill backwards: the acceleration is the lowest.
            change = max(speed, min(MARGIN * low, 0.0) * seconds)
        return before + sign * change

    @staticmethod
    def _brakes(standing: Standing, left: float, sign: float) -> float:
        """Return the deceleration in m/s2 that is allowed where no margin is left."""
        low, high = standing.accelerations(left, 0.0)
        return min(BRAKES, max(LEAST_BRAKES, SLIPS * (-low if sign > 0.0 else high)))

    def top_speed(self, state: RarsState, direction: float, bend_per_m: float) -> float:
        """Return the speed in m/s, ahead for a positive direction, that the robot may have; inf for any.

        0 where a start that way would take the margin, or a turn as it is steered.
        """
        standing, balance = self._standing(state.lift_m, state.tilt_rad), self._balance
        if standing is None or balance is None:
            return math.inf
        if self._friction(standing) > balance.floor_friction:
            return 0.0
        needed = balance.needed(standing.height_m)
        low, high = standing.accelerations(0.0, needed)
        if (high < STARTS) if direction > 0.0 else (low > -STARTS):
            return 0.0
        top = SAFE_SHARE * standing.safe_speed(direction)
        if bend_per_m == 0.0:
            return top
        right, left = standing.turns(0.0, needed)
        room = left if bend_per_m > 0.0 else -right
        return min(top, math.sqrt(max(MARGIN * room, 0.0) / abs(bend_per_m)))

    def slides(self, state: RarsState) -> str:
        """Return why its rear wheels would not hold it on the slope; empty where they do."""
        standing, balance = self._standing(state.lift_m, state.tilt_rad), self._balance
        if standing is None or balance is None:
            return ""
        needed = self._friction(standing)
        if needed <= balance.floor_friction:
            return ""
        return (
            f"its rear wheels need a friction of {needed:.2f} to hold it, the floor has "
            f"{balance.floor_friction:.2f}"
        )

    def _friction(self, standing: Standing) -> float:
        return HOLDS * standing.friction(0.0, self._base.wheelbase_m)

    def highest_lift(self, state: RarsState) -> float:
        """Return the height above retracted, in m, up to which the table may rise; inf for any."""
        standing, balance = self._standing(state.lift_m, state.tilt_rad), self._balance
        if standing is None or balance is None:
            return math.inf
        height = min(
            standing.highest(balance.needed(standing.height_m)),
            standing.highest_held(balance.floor_friction / HOLDS, 0.0, self._base.wheelbase_m),
        )
        return math.inf if height == math.inf else balance.lift_for(self._base, height)

    def _standing(self, lift_m: float | None, tilt_rad: tuple[float, float] | None) -> Standing | None:
        balance = self._balance
        if balance is None or tilt_rad is None or lift_m is None:
            return None
        centre = (self._base.centre_offset_m, 0.0, balance.height(self._base, lift_m))
        return Standing(self._corners, centre, *tilt_rad)
