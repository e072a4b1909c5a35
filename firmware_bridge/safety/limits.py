"""The limits: what clips a wish that is otherwise allowed, each with its name, bounds and reason.

Source: A. P. Das, PhD thesis, IIT Delhi, 2018, 2.3.1 (tipping, acceleration), 4.2 and Tab. 2.1 (speed, turn).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from firmware_bridge.motion import davis, lift
from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import MILLISECOND, STANDARD_GRAVITY, Nanoseconds

CLEARS_AFTER: Final[Nanoseconds] = 300 * MILLISECOND
"""A limit is reported for at least this long, so that a stick at its edge does not flicker."""
ROUNDING: Final = 1e-6
"""Share of a bound: a wish that came as a 32-bit float is not above a bound by its rounding. It is clipped
all the same, only not reported."""


@dataclass(frozen=True, slots=True)
class Limit:
    """One bound of one field of the wish, the same to both sides unless `low` says otherwise."""

    name: str
    field: str
    """The field of `firmware_bridge.intent.Intent`."""
    high: Callable[[Robot, Snapshot], float]
    remedy: str
    unit: str
    scale: float = 1.0
    """From SI to the unit of the text."""
    low: float | None = None
    """None: the negative of `high`."""

    def clip(self, value: float, robot: Robot, seen: Snapshot) -> tuple[float, str | None]:
        """Return the value within the bounds, and the reason where it was outside."""
        high = self.high(robot, seen)
        low = -high if self.low is None else self.low
        allowed = min(max(value, low), high)
        if abs(value - allowed) <= ROUNDING * high:
            return allowed, None
        shown, bound = value * self.scale, allowed * self.scale
        return allowed, f"asked for {shown:.2f} {self.unit}, allowed is {bound:.2f} {self.unit}"


def tipping_speed(robot: Robot, steer_rad: float) -> float:
    """Return the speed in m/s at which the turn tips the robot over, sqrt(R g d / Zcg) (2.7)."""
    radius = davis.turn_radius(robot.base, steer_rad)
    arm = robot.base.half_support_width_m / robot.base.centre_of_gravity_height_m
    return math.sqrt(radius * STANDARD_GRAVITY * arm)


def tightest_steer(robot: Robot) -> float:
    """Return the inner wheel's angle in rad of the tightest turn, 58.95 degrees for 415 mm (2.13)."""
    return davis.steer_from_curvature(robot.base, 1.0 / robot.limits.turn_radius_m)


def _top_speed(robot: Robot, _seen: Snapshot) -> float:
    return robot.limits.speed_mps


def _tipping_speed(robot: Robot, seen: Snapshot) -> float:
    # The turn actually steered, not the one asked for: the wheels may still be on their way.
    steer = seen.steer_rad
    return tipping_speed(robot, steer) if steer is not None and math.isfinite(steer) else 0.0


def _top_steer(robot: Robot, _seen: Snapshot) -> float:
    return math.radians(robot.limits.steer_angle_deg)


def _tightest_steer(robot: Robot, _seen: Snapshot) -> float:
    return tightest_steer(robot)


def _top_lift_rate(robot: Robot, _seen: Snapshot) -> float:
    return robot.limits.lift_rate_mps


def _highest_lift(robot: Robot, _seen: Snapshot) -> float:
    return lift.highest(robot.lift)


_DEGREES: Final = 180.0 / math.pi

LIMITS: Final = (
    Limit("speed limit", "speed_mps", _top_speed, "ask for less speed", "m/s"),
    Limit("tipping limit", "speed_mps", _tipping_speed, "steer less or ask for less speed", "m/s"),
    Limit("steer angle limit", "steer_rad", _top_steer, "steer less", "deg", _DEGREES),
    Limit("turn radius limit", "steer_rad", _tightest_steer, "steer less", "deg", _DEGREES),
    Limit("lift rate limit", "lift_rate_mps", _top_lift_rate, "ask for a slower lift", "m/s"),
    Limit("lift range limit", "lift_m", _highest_lift, "ask for a height within reach", "m", low=0.0),
)
"""Every limit on a field of the wish, applied in this order; a later one sees what an earlier one left."""

ACCELERATION_LIMIT: Final = "acceleration limit"
ACCELERATION_REMEDY: Final = "change the speed more slowly"
