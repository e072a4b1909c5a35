"""Scissor lift: height above collapsed, screw travel and angle (A. P. Das, thesis 2.5, (2.16)); lengths in m.

N stages of links l at angle theta: height N l sin(theta); the screw pulls the foot along x = l cos(theta).
Speeds and limits are not known here: a caller clips to `highest`.
"""

import math

from firmware_bridge.motion.tables import ScissorLift


def highest(lift: ScissorLift) -> float:
    """Return the height in m of the extended lift above the collapsed one."""
    return _height(lift, math.radians(lift.extended_angle_deg))


def travel_from_height(lift: ScissorLift, height_m: float) -> float:
    """Return the screw's travel in m from collapsed, growing upwards."""
    collapsed = math.radians(lift.collapsed_angle_deg)
    angle = math.asin(height_m / (lift.stages * lift.link_length_m) + math.sin(collapsed))
    return lift.link_length_m * (math.cos(collapsed) - math.cos(angle))


def height_from_travel(lift: ScissorLift, travel_m: float) -> float:
    """Return the height in m above collapsed.

    A travel that the scissor cannot make counts as its nearest end, 0 or 90 degrees: an encoder that reads
    nonsense must not end in an exception.
    """
    cosine = math.cos(math.radians(lift.collapsed_angle_deg)) - travel_m / lift.link_length_m
    return _height(lift, math.acos(min(max(cosine, 0.0), 1.0)))


def screw_from_height(lift: ScissorLift, height_m: float) -> float:
    """Return the screw's angle in rad from collapsed."""
    return 2.0 * math.pi * (travel_from_height(lift, height_m) / lift.screw_pitch_m)


def height_from_screw(lift: ScissorLift, screw_rad: float) -> float:
    """Return the height in m above collapsed for the screw's angle."""
    return height_from_travel(lift, screw_rad / (2.0 * math.pi) * lift.screw_pitch_m)


def _height(lift: ScissorLift, angle_rad: float) -> float:
    rise = math.sin(angle_rad) - math.sin(math.radians(lift.collapsed_angle_deg))
    return lift.stages * lift.link_length_m * rise
