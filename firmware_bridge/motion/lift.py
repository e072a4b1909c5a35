"""Scissor lift: height above collapsed, screw travel, drive position (thesis 2.5, (2.16)); lengths in m.

N stages of links l at angle theta: height N l sin(theta); the screw pulls the foot along x = l cos(theta).
It refuses to know speeds and limits: a caller clips to `highest`.
"""

import math

from firmware_bridge.robot import Axis, Lift


def highest(lift: Lift) -> float:
    """Return the height in m of the extended lift above the collapsed one."""
    return _height(lift, math.radians(lift.extended_angle_deg))


def screw_from_height(lift: Lift, height_m: float) -> float:
    """Return the screw's travel in m from collapsed, growing upwards."""
    collapsed = math.radians(lift.collapsed_angle_deg)
    angle = math.asin(height_m / (lift.stages * lift.link_length_m) + math.sin(collapsed))
    return lift.link_length_m * (math.cos(collapsed) - math.cos(angle))


def height_from_screw(lift: Lift, travel_m: float) -> float:
    """Return the height in m above collapsed.

    A travel that the scissor cannot make counts as its nearest end, 0 or 90 degrees: an encoder that reads
    nonsense must not end in an exception.
    """
    cosine = math.cos(math.radians(lift.collapsed_angle_deg)) - travel_m / lift.link_length_m
    return _height(lift, math.acos(min(max(cosine, 0.0), 1.0)))


def lift_quadcounts(lift: Lift, axis: Axis, height_m: float) -> int:
    """Return the lift drive's position, nearest quadcount; the drive counts from collapsed."""
    turns = screw_from_height(lift, height_m) / lift.screw_pitch_m
    return round(2.0 * math.pi * turns * axis.quadcounts_per_radian)


def height_from_quadcounts(lift: Lift, axis: Axis, position_qc: int) -> float:
    """Return the height in m above collapsed for the lift drive's position."""
    turns = position_qc / axis.quadcounts_per_radian / (2.0 * math.pi)
    return height_from_screw(lift, turns * lift.screw_pitch_m)


def _height(lift: Lift, angle_rad: float) -> float:
    rise = math.sin(angle_rad) - math.sin(math.radians(lift.collapsed_angle_deg))
    return lift.stages * lift.link_length_m * rise
