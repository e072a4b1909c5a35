"""Views of a base on three omni wheels: from above, and from ahead."""

import math
from typing import Final

from firmware_bridge.motion.omni import ANGLES
from firmware_bridge.robots.rome.geometry import Base
from validation.pages.sheet import FLOOR, GREEN, SCHEMATIC, SUPPORT, View
from validation.pages.sheet import millimeters as mm

TIRE_M: Final = 0.03
"""Width of a wheel in a drawing; no robot file has it."""
NAMES: Final = ("one", "two", "three")


def base_from_above(view: View, base: Base, *, sized: bool = True) -> None:
    """Draw wheels, support polygon and, where `sized`, the dimensions."""
    distance, radius, half = base.wheel_distance_m, base.wheel_radius_m, TIRE_M / 2.0
    contacts = [(distance * math.cos(angle), distance * math.sin(angle)) for angle in ANGLES]
    view.circle((0.0, 0.0), distance - half, SCHEMATIC)
    view.line(*contacts, stroke=SUPPORT, closed=True)
    for angle, (x, y), name in zip(ANGLES, contacts, NAMES, strict=True):
        out, along = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
        corners = ((half, radius), (-half, radius), (-half, -radius), (half, -radius))
        view.line(
            *((x + o * out[0] + a * along[0], y + o * out[1] + a * along[1]) for o, a in corners), closed=True
        )
        if sized:
            view.text((x, y), name, (38.0 * out[0], 30.0 * out[1] - 4.0))
    if not sized:
        return
    view.size((0.0, 0.0), contacts[0], mm(distance), 0.0)
    # A side of the triangle is half as far from the middle as its corners.
    view.size((0.0, 0.0), (-distance / 2.0, 0.0), mm(distance / 2.0), 0.0)
    view.size(contacts[2], contacts[1], f"between wheels {mm(math.dist(contacts[1], contacts[2]))}", 70.0)
    view.text((-distance / 2.0, 0.0), "support polygon", (8.0, -24.0), color=GREEN, anchor="start")


def base_from_the_side(view: View, base: Base, *, sized: bool = True) -> None:
    """Draw the wheels as they are seen against x, y to the left turned to the right."""
    distance, radius = base.wheel_distance_m, base.wheel_radius_m
    view.line((-distance * 1.3, 0.0), (distance * 1.3, 0.0), stroke=FLOOR)
    view.box((-distance, radius * 0.9), (distance, radius * 2.0), SCHEMATIC)
    places = [distance * math.sin(angle) for angle in ANGLES]
    for angle, place, name in sorted(zip(ANGLES, places, NAMES, strict=True), reverse=True):
        # A wheel's axle points outwards: seen against x it is as narrow as its axle is across.
        view.circle((place, radius), radius, across=max(radius * abs(math.cos(angle)), TIRE_M / 2.0))
        if sized:
            view.text((place, radius), name, (0.0, -4.0))
    if not sized:
        return
    view.size((places[2], 0.0), (places[1], 0.0), mm(places[1] - places[2]), -30.0)
    view.size((distance * 1.3, 0.0), (distance * 1.3, radius), mm(radius), -20.0)
