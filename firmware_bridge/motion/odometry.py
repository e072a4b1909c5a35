"""Pose of a robot on two wheels of one axle, by their rolling; it knows no drive and no bus.

The thesis advances the pose by forward Euler every 50 ms (4.13)-(4.15): its largest error on a closed circle
is v dt, because each step runs along the old heading. Here each step is the exact arc of two wheels that
roll with constant speed and do not slip, so a circle closes whatever the cycle.
"""

import math
from typing import Final

from firmware_bridge.motion.pose import Pose

_STRAIGHT_RAD: Final = 1e-6
"""Below this turn a step is a straight line; the arc then differs by less than 1e-12 of its length."""


def moved(pose: Pose, left_m: float, right_m: float, track_m: float) -> Pose:
    """Return the pose after the two wheels rolled these lengths, exact for constant speeds."""
    length = (left_m + right_m) / 2.0
    turn = (right_m - left_m) / track_m
    half = turn / 2.0
    # The chord of an arc is shorter than the arc by sin(half) / half, and 0 / 0 straight ahead.
    chord = length if abs(turn) < _STRAIGHT_RAD else length * math.sin(half) / half
    course = pose.heading_rad + half
    return Pose(
        pose.x_m + chord * math.cos(course),
        pose.y_m + chord * math.sin(course),
        pose.heading_rad + turn,
    )
