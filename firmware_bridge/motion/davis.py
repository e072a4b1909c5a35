"""Davis steering: rack, wheel angles, turn and rear wheel speeds; lengths in m, angles in rad, left positive.

`steer` is everywhere the angle of the INNER front wheel with the sign of the turn. The thesis (A. P. Das, IIT
Delhi, 2018) writes (4.7) for one side only and names the wheel of (4.10), (4.11) wrongly; here both sides
mirror each other. Limits are not known here: a caller clips.
"""

import math

from firmware_bridge.motion.tables import DavisBase


def rack_from_steer(base: DavisBase, steer_rad: float) -> float:
    """Return the rack's travel in m for an inner wheel angle (4.7), |steer| below 90 degrees."""
    h, b = base.davis_h_m, base.davis_b_m
    tangent = math.tan(abs(steer_rad))
    return math.copysign(tangent * (h * h + b * b) / (h + b * tangent), steer_rad)


def steer_from_rack(base: DavisBase, rack_m: float) -> float:
    """Return the inner wheel's angle for the rack's travel (4.6)."""
    h, b = base.davis_h_m, base.davis_b_m
    travel = abs(rack_m)
    return math.copysign(math.atan2(travel * h, h * h + b * b - b * travel), rack_m)


def outer_from_rack(base: DavisBase, rack_m: float) -> float:
    """Return the outer wheel's angle for the rack's travel (4.6)."""
    h, b = base.davis_h_m, base.davis_b_m
    travel = abs(rack_m)
    return math.copysign(math.atan2(travel * h, h * h + b * b + b * travel), rack_m)


def pinion_from_steer(base: DavisBase, steer_rad: float) -> float:
    """Return the pinion's angle (4.8), the angle behind the steering gear, for an inner wheel angle."""
    return 2.0 * rack_from_steer(base, steer_rad) / base.pinion_diameter_m


def steer_from_pinion(base: DavisBase, pinion_rad: float) -> float:
    """Return the inner wheel's angle for the pinion's angle (4.8)."""
    return steer_from_rack(base, pinion_rad * base.pinion_diameter_m / 2.0)


def curvature(base: DavisBase, steer_rad: float) -> float:
    """Return 1/R of the rear axle's middle in 1/m (2.13), left positive, 0 straight ahead."""
    sine, cosine = math.sin(steer_rad), math.cos(steer_rad)
    # (2.13) with sine and cosine: the cotangent that is printed has no value straight ahead.
    return sine / (base.kingpin_distance_m / 2.0 * abs(sine) + base.wheelbase_m * cosine)


def turn_radius(base: DavisBase, steer_rad: float) -> float:
    """Return the radius in m of the rear axle's middle (2.13), never negative, infinite straight ahead."""
    bend = abs(curvature(base, steer_rad))
    return 1.0 / bend if bend else math.inf


def steer_from_curvature(base: DavisBase, curvature_per_m: float) -> float:
    """Return the inner wheel's angle that turns with this curvature; the inverse of `curvature`.

    A turn tighter than half the kingpin distance answers with more than 90 degrees.
    """
    bend = abs(curvature_per_m)
    angle = math.atan2(base.wheelbase_m * bend, 1.0 - base.kingpin_distance_m / 2.0 * bend)
    return math.copysign(angle, curvature_per_m)


def wheel_speeds(base: DavisBase, speed_mps: float, curvature_per_m: float) -> tuple[float, float]:
    """Return the left and right rear wheels' speeds in rad/s for a curvature (4.10), (4.11).

    That is the CURRENT steer angle's. The inner wheel turns with (V/r)(1 - m/R), the outer one with
    (V/r)(1 + m/R), m half the rear track.
    """
    rolling = speed_mps / base.wheel_radius_m
    difference = base.rear_track_m / 2.0 * curvature_per_m
    return rolling * (1.0 - difference), rolling * (1.0 + difference)
