"""Pitch and roll from gyro and accelerometer: a complementary filter of the upward direction.

The upward direction u in the robot's axes turns with the rates w, u' = u x w, and follows the accelerometer's
direction with the time constant T. So an error of the rate of b makes one of b T, and braking, which tilts
the accelerometer's direction at once, moves u by its share of 1 - exp(-t / T) only. The accelerometer does
not count where its length is not 1 g, and counts a tenth while the robot turns: there it has the centripetal
acceleration, for as long as the turn lasts. It is the passive filter of R. Mahony et al., IEEE Trans. Autom.
Control 53(5), 2008, without its estimate of the bias; that is measured at the first standstill.

All figures are assumed; only T is in the robot file.
"""

import math
from enum import Enum
from typing import Final

from firmware_bridge.families.imu.driver.axes import Vector, cross, length, plus, unit
from firmware_bridge.units import STANDARD_GRAVITY

SETTLING: Final = 100
"""Frames, 1 s, whose mean is where the filter begins."""
STEADY_RAD_S: Final = math.radians(2.0)
"""Largest difference of the rates in that time at a standstill; noise alone has 0.4 deg/s."""
BIAS_RAD_S: Final = math.radians(5.0)
"""Largest rate at standstill that is taken for the gyro's bias."""
LEVEL_G: Final = 0.03
"""Largest deviation of the specific force from 1 g at which its direction counts as upwards."""
TURNS_RAD_S: Final = math.radians(3.0)
"""Rate about the upward direction above which the robot turns."""
IN_TURNS: Final = 0.1
"""Share of the accelerometer in a turn."""
NO_DIRECTION: Final = 1e-9
"""A sum of directions that is shorter has none."""


class Phase(Enum):
    """Phase of the filter."""

    SETTLING = "settling"
    """It has less than `SETTLING` frames."""
    MOVING = "the robot moves: the bias of the rates is not known before it stands for 1 s"
    READY = "ready"


class Attitude:
    """The upward direction, frame by frame."""

    def __init__(self, time_constant_s: float) -> None:
        self._constant: Final = time_constant_s
        self.phase = Phase.SETTLING
        self.up: Vector = (0.0, 0.0, 1.0)
        """The upward direction in the robot's axes."""
        self.bias: Vector = (0.0, 0.0, 0.0)
        """The rates at standstill, rad/s."""
        self._zeroed = False
        """True once the bias is known."""
        self._frames = 0
        self._sum: Vector = (0.0, 0.0, 0.0)
        self._low: Vector = (0.0, 0.0, 0.0)
        self._high: Vector = (0.0, 0.0, 0.0)

    @property
    def pitch(self) -> float:
        """Nose up positive, rad, from -pi/2 to pi/2."""
        x, y, z = self.up
        return math.atan2(x, math.hypot(y, z))

    @property
    def roll(self) -> float:
        """Left side up positive, rad, from -pi to pi."""
        return math.atan2(self.up[1], self.up[2])

    def restart(self) -> None:
        """Begin again at the accelerometer's direction; the bias stays."""
        self._frames = 0
        if self.phase is Phase.READY:
            self.phase = Phase.SETTLING

    def step(self, force: Vector, rate: Vector, seconds: float) -> None:
        """Take a specific force in m/s2 and rates in rad/s, so many seconds after those before."""
        if self._frames == 0:
            self._begin(force, rate)
            return
        # Before the bias is known the robot stands, or nothing is reported.
        turned = plus(rate, -1.0, self.bias) if self._zeroed else (0.0, 0.0, 0.0)
        # To the second order: a robot that falls over turns by some degrees from frame to frame.
        half = plus(self.up, 0.5 * seconds, cross(self.up, turned))
        self.up = unit(plus(self.up, seconds, cross(half, turned)))
        self._frames += 1
        share = self._share(force, turned, seconds)
        if share > 0.0:
            between = plus(self.up, share, plus(unit(force), -1.0, self.up))
            # Between two opposite directions there is none: a device that lies ends no bridge.
            self.up = unit(between) if length(between) > NO_DIRECTION else self.up
        if self.phase is not Phase.READY:
            self._settle(rate)

    def _begin(self, force: Vector, rate: Vector) -> None:
        if length(force) == 0.0:
            return
        self.up = unit(force)
        self._frames, self._sum, self._low, self._high = 1, rate, rate, rate

    def _share(self, force: Vector, turned: Vector, seconds: float) -> float:
        """Return the accelerometer's share in this frame."""
        off = length(force) / STANDARD_GRAVITY - 1.0
        if self.phase is not Phase.READY:
            # The mean of all so far; the length is judged elsewhere.
            return 1.0 / self._frames if abs(off) < 1.0 else 0.0
        if abs(off) > LEVEL_G:
            return 0.0
        share = seconds / (self._constant + seconds)
        about = self.up[0] * turned[0] + self.up[1] * turned[1] + self.up[2] * turned[2]
        return share * IN_TURNS if abs(about) > TURNS_RAD_S else share

    def _settle(self, rate: Vector) -> None:
        """Measure the bias, once, and end the settling."""
        low, high = self._low, self._high
        self._sum = plus(self._sum, 1.0, rate)
        self._low = min(low[0], rate[0]), min(low[1], rate[1]), min(low[2], rate[2])
        self._high = max(high[0], rate[0]), max(high[1], rate[1]), max(high[2], rate[2])
        if not self._zeroed and max(plus(self._high, -1.0, self._low)) > STEADY_RAD_S:
            self.phase, self._frames = Phase.MOVING, 0
        elif self._frames >= SETTLING:
            mean = plus((0.0, 0.0, 0.0), 1.0 / self._frames, self._sum)
            if self._zeroed:
                self.phase = Phase.READY
            elif length(mean) > BIAS_RAD_S:
                self.phase, self._frames = Phase.MOVING, 0
            else:
                self.bias, self._zeroed, self.phase = mean, True, Phase.READY
