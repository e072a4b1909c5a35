"""Three omni wheels at 0, 120 and 240 degrees: rim speeds from a motion and back, ramp, exact odometry.

Source: A. Seleit, MSc thesis, UCF, 2020, (2.13) and (2.14), which are right; (2.9) to (2.11) turn the wheels'
places twice. Wheel i drives along psi + z_i + 90 degrees, so three rims forwards turn counter-clockwise.

Three rims and three ways to move: a motion determines the rims and the rims the motion. Nothing is left over
that would reveal slip.
"""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

from firmware_bridge.motion.pose import Pose
from firmware_bridge.units import Nanoseconds, to_seconds

ANGLES: Final[tuple[float, ...]] = (0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0)
"""Angles of the wheels."""
_STRAIGHT_RAD: Final = 1e-6


class BodyTwist(NamedTuple):
    """Motion of a body in its own frame; SI, left and counter-clockwise positive."""

    ahead: float
    left: float
    turn: float


def rims(twist: BodyTwist, distance_m: float) -> tuple[float, float, float]:
    """Return the rims' speeds in m/s for a motion in the body's own frame, P(0) of (2.13)."""
    one, two, three = (
        -math.sin(angle) * twist.ahead + math.cos(angle) * twist.left + distance_m * twist.turn
        for angle in ANGLES
    )
    return one, two, three


def twist(speeds: tuple[float, float, float], distance_m: float) -> BodyTwist:
    """Return the motion for the rims' speeds in m/s, the inverse of P(0) (2.14)."""
    pairs = list(zip(ANGLES, speeds, strict=True))
    return BodyTwist(
        # The squares of the three sines, as of the cosines, add up to 3 / 2.
        sum(-math.sin(angle) * speed for angle, speed in pairs) * 2.0 / 3.0,
        sum(math.cos(angle) * speed for angle, speed in pairs) * 2.0 / 3.0,
        sum(speeds) / (3.0 * distance_m),
    )


def shortened(wanted: BodyTwist, distance_m: float, rim_mps: float) -> BodyTwist:
    """Return the motion, made so slow as a whole that no rim is faster than `rim_mps`."""
    fastest = max(map(abs, rims(wanted, distance_m)))
    share = rim_mps / fastest if fastest > rim_mps else 1.0
    return BodyTwist(share * wanted.ahead, share * wanted.left, share * wanted.turn)


def moved(pose: Pose, way: BodyTwist) -> Pose:
    """Return the pose after a way in m and rad in the body's frame, exact for constant speeds."""
    half = way.turn / 2.0
    chord = 1.0 if abs(way.turn) < _STRAIGHT_RAD else math.sin(half) / half
    course = pose.heading_rad + half
    sine, cosine = math.sin(course), math.cos(course)
    return Pose(
        pose.x_m + chord * (way.ahead * cosine - way.left * sine),
        pose.y_m + chord * (way.ahead * sine + way.left * cosine),
        pose.heading_rad + way.turn,
    )


@dataclass(frozen=True, slots=True)
class OmniRamp:
    """Straight from one motion to the next, so that what both keep to is kept in between."""

    acceleration_mps2: float
    turn_acceleration_rad_s2: float
    longest_step: Nanoseconds
    """A late cycle counts as no more than this: a gap must not become a jump."""

    def step(self, before: BodyTwist, target: BodyTwist, elapsed: Nanoseconds) -> BodyTwist:
        """Return the next set-point, `elapsed` after `before`."""
        seconds = to_seconds(min(elapsed, self.longest_step))
        change = BodyTwist(*(new - old for old, new in zip(before, target, strict=True)))
        # The slowest of all changes gives the time, so that the motion goes straight to its target.
        along = math.hypot(change.ahead, change.left) / self.acceleration_mps2
        needed = max(along, abs(change.turn) / self.turn_acceleration_rad_s2)
        if needed <= seconds:
            return target
        share = seconds / needed
        return BodyTwist(*(old + share * step for old, step in zip(before, change, strict=True)))
