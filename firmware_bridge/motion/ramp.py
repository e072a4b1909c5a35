"""The base speed's way to its target: never more acceleration than the robot stands.

Two bounds hold at once (thesis 2.3.1 for the limit): the vector sum of the acceleration along the path and
the centripetal one, V^2/R; and the rim acceleration of the faster rear wheel, which is 1 + m/R times that of
the base, and V m d(1/R)/dt more while the turn changes.
"""

import math
from typing import Final

from firmware_bridge.units import Nanoseconds, to_seconds
from firmware_bridge.value import valueclass

MARGIN: Final = 0.80
"""Share of the limit that set-points use: 0.862, because wheels that brake at the limit slip by 13.8 % on a
floor of 0.3, times 0.93 for what a drive's regulators overshoot at a corner of the profile. It belongs to
floors and regulators, not to a robot: docs/decisions/motion-limits.md."""

BRAKING_SHARE: Final = 0.5
"""Share of the limit that braking may always use. If a turn tightens until V^2/R alone takes the whole
limit, a robot that may not brake would be the greater danger."""

CATCHES_UP: Final = 0.85
"""Share of the limit with which a rim speeds up in a turn, or while the turn changes. A wheel falls behind
its set-point by the 10 ms in which it breaks loose, or by a late frame: with the rest it catches up, and the
ratio of both wheels with it."""
TURN_PER_M: Final = 0.02
"""Curvature from which on it counts as one."""


@valueclass(frozen=True, slots=True)
class Ramp:
    """Bounds of one robot."""

    limit_mps2: float
    """Of the set-points: `MARGIN` of what the robot stands."""
    half_track_m: float
    longest_step: Nanoseconds
    """A late cycle counts as no more than this: a gap must not become a jump."""

    def step(
        self,
        speed_mps: float,
        target_mps: float,
        bend_per_m: float,
        elapsed: Nanoseconds,
        turning_per_m_s: float = 0.0,
    ) -> float:
        """Return the next demanded base speed in m/s, `elapsed` after `speed_mps`.

        `bend_per_m` is the curvature of the turn actually steered, `turning_per_m_s` how fast it changes;
        their signs do not matter.
        """
        bend = abs(bend_per_m)
        target = self._clipped(target_mps, bend)
        seconds = to_seconds(min(elapsed, self.longest_step))
        reach = self.limit_mps2 * seconds
        nearest = min(max(target, speed_mps - reach), speed_mps + reach)
        # The faster end of the step has the larger centripetal acceleration.
        fastest = max(abs(speed_mps), abs(nearest))
        along = math.sqrt(max(self.limit_mps2**2 - (fastest**2 * bend) ** 2, 0.0))
        brakes = abs(nearest) < abs(speed_mps)
        if brakes:
            along = max(along, BRAKING_SHARE * self.limit_mps2)
        rim = self.limit_mps2
        if turning_per_m_s or (bend > TURN_PER_M and not brakes):
            rim *= CATCHES_UP
        rim -= fastest * self.half_track_m * abs(turning_per_m_s)
        if brakes:
            rim = max(rim, BRAKING_SHARE * self.limit_mps2)
        rim = max(rim, 0.0) / (1.0 + self.half_track_m * bend)
        change = min(along, rim) * seconds
        return min(max(target, speed_mps - change), speed_mps + change)

    def _clipped(self, target_mps: float, bend: float) -> float:
        # Above this speed the centripetal acceleration alone would pass the limit.
        top = math.sqrt(self.limit_mps2 / bend) if bend else math.inf
        return min(max(target_mps, -top), top)
