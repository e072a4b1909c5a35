"""Differential drive: two wheels on one axle, each with its own motor; lengths in m, left positive.

The robot's point is the middle of the axle; the castors follow. Limits beyond the ramp's are not known here.
"""

import math
from dataclasses import dataclass

from firmware_bridge.motion.tables import DifferentialBase
from firmware_bridge.units import Nanoseconds, to_seconds


def wheel_speeds(base: DifferentialBase, speed_mps: float, turn_rad_s: float) -> tuple[float, float]:
    """Return the left and the right wheel's speed in rad/s for a speed and a turn rate."""
    difference = turn_rad_s * base.track_m / 2.0
    return (speed_mps - difference) / base.wheel_radius_m, (speed_mps + difference) / base.wheel_radius_m


def twist(base: DifferentialBase, left_rad_s: float, right_rad_s: float) -> tuple[float, float]:
    """Return speed in m/s and turn rate in rad/s for two wheels that do not slip."""
    left_mps, right_mps = left_rad_s * base.wheel_radius_m, right_rad_s * base.wheel_radius_m
    return (left_mps + right_mps) / 2.0, (right_mps - left_mps) / base.track_m


@dataclass(frozen=True, slots=True)
class DifferentialRamp:
    """The way of speed and turn rate to their targets; each has its bound, and so have both together."""

    acceleration_mps2: float
    """Of the axle's middle, and of the faster wheel's rim."""
    turn_acceleration_rad_s2: float
    sideways_mps2: float
    """Of the centripetal acceleration, speed times turn rate: what would pass it does not grow."""
    half_track_m: float
    longest_step: Nanoseconds
    """A late cycle counts as no more than this: a gap must not become a jump."""

    def step(
        self, commanded: tuple[float, float], target: tuple[float, float], elapsed: Nanoseconds
    ) -> tuple[float, float]:
        """Return the next speed and turn rate, `elapsed` after those demanded."""
        seconds = to_seconds(min(elapsed, self.longest_step))
        reach = self.acceleration_mps2 * seconds
        faster = _clipped(target[0] - commanded[0], reach)
        tighter = _clipped(target[1] - commanded[1], self.turn_acceleration_rad_s2 * seconds)
        # The outer wheel's rim has both changes at once; one share for both keeps the shape of the turn.
        rim = abs(faster) + abs(tighter) * self.half_track_m
        share = 1.0 if rim <= reach else reach / rim
        speed, turn = commanded[0] + share * faster, commanded[1] + share * tighter
        # What would pass the limit does not grow; what is there already is not cut off at once.
        if abs(speed * turn) > self.sideways_mps2:
            turn = _clipped(turn, max(abs(commanded[1]), self.sideways_mps2 / abs(speed)))
        if abs(speed * turn) > self.sideways_mps2:
            speed = _clipped(speed, max(abs(commanded[0]), self.sideways_mps2 / abs(turn)))
        return speed, turn


def fastest_in_turn(turn_rad_s: float, sideways_mps2: float) -> float:
    """Return the speed in m/s at which a turn pulls sideways so much; infinite straight ahead."""
    return sideways_mps2 / abs(turn_rad_s) if turn_rad_s else math.inf


def _clipped(value: float, bound: float) -> float:
    return min(max(value, -bound), bound)
