"""Drawings of the shipped robots with their dimensions, from the numbers of their robot files.

`python -m validation.pages.drawings` writes docs/pictures/ROBOT.svg.
"""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from firmware_bridge.families.epos2.settings import Epos2AnalogueInput
from firmware_bridge.motion.davis import outer_from_rack, rack_from_steer
from firmware_bridge.motion.scissor import highest
from firmware_bridge.motion.tables import ScissorLift
from firmware_bridge.robot import AnyRobot, Robot
from firmware_bridge.robot_types import find
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rome.geometry import RomeGeometry
from validation.pages.arm_drawings import ar2, rome_arm
from validation.pages.axis_drawing import servo_axis
from validation.pages.base_views import base_from_above, base_from_the_side
from validation.pages.sheet import (
    BLUE,
    FLOOR,
    GREEN,
    LIMIT,
    PURPLE,
    SCHEMATIC,
    SENSOR,
    SUPPORT,
    VERMILION,
    Point,
    View,
    svg,
)
from validation.pages.sheet import millimeters as mm

FOLDER: Final = Path(__file__).parents[2] / "docs" / "pictures"
TIRE_M: Final = 0.03
"""Width of a wheel in a drawing; no robot file has it."""
LEGEND: Final = (
    "Dimensions in mm, from the robot file; each view has a scale of its own. "
    "Gray dashed: not in the robot file, schematic. Green: support. Red: limit."
)


def _tire(view: View, middle: Point, radius: float, angle: float = 0.0) -> None:
    """Draw a wheel from above that rolls at an angle."""
    cosine, sine = math.cos(angle), math.sin(angle)
    half = TIRE_M / 2.0
    corners = ((radius, half), (radius, -half), (-radius, -half), (-radius, half))
    view.line(
        *((middle[0] + x * cosine - y * sine, middle[1] + x * sine + y * cosine) for x, y in corners),
        closed=True,
    )


def _axes(robot: AnyRobot) -> str:
    return "Axes: " + "; ".join(f"{axis.title} ({axis.settings.address})" for axis in robot.axes) + "."


def _sensors(robot: AnyRobot) -> str:
    """Return each analog input of a drive, and what it measures."""
    read = [(it.title, it.settings) for it in robot.sensors if isinstance(it.settings, Epos2AnalogueInput)]
    each = (f"{title} ({it.axis} drive, analog input {it.input})" for title, it in read)
    return "Sensors: " + "; ".join(each) + "."


def _rars_above(geometry: RarsGeometry) -> View:
    base, limits = geometry.base, geometry.limits
    track, kingpin, ahead = base.rear_track_m / 2.0, base.kingpin_distance_m / 2.0, base.wheelbase_m
    view = View("Top view, tightest left turn")
    inner = geometry.tightest_steer_rad
    outer = outer_from_rack(base, rack_from_steer(base, inner))
    view.line((0.0, -track), (0.0, track), stroke=SCHEMATIC)
    view.line((ahead, -kingpin), (ahead, kingpin), stroke=SCHEMATIC)
    view.line((0.0, 0.0), (ahead, 0.0), stroke=SCHEMATIC)
    for side, name in ((1.0, "left"), (-1.0, "right")):
        _tire(view, (0.0, side * track), base.wheel_radius_m)
        view.text((0.0, side * track), name, (30.0, -4.0), anchor="start")
        edge = side * base.half_support_width_m
        view.line((-0.06, edge), (ahead + 0.08, edge), stroke=SUPPORT)
    _tire(view, (ahead, kingpin), base.wheel_radius_m, inner)
    _tire(view, (ahead, -kingpin), base.wheel_radius_m, outer)
    center = (0.0, limits.turn_radius_m)
    for point in ((ahead, kingpin), (ahead, -kingpin), (0.0, track)):
        view.line(center, point, stroke=LIMIT)
    view.text(center, "center of turn", (10.0, 8.0), color=VERMILION, anchor="start")
    view.size((0.0, -track), (ahead, -track), f"wheelbase {mm(ahead)}", -34.0)
    view.size((0.0, -track), (0.0, track), f"rear track {mm(base.rear_track_m)}", 40.0)
    view.size((ahead, -kingpin), (ahead, kingpin), f"kingpins {mm(base.kingpin_distance_m)}", -52.0)
    half = base.half_support_width_m
    view.size((ahead * 0.36, 0.0), (ahead * 0.36, half), f"{mm(half)}", 0.0)
    view.text((ahead * 0.36, -half), "tipping line", (0.0, 6.0), color=GREEN)
    view.size(center, (0.0, 0.0), f"least turn radius {mm(limits.turn_radius_m)}", -72.0)
    view.text((ahead, kingpin), f"{math.degrees(inner):.1f}°", (38.0, 8.0), color=VERMILION)
    return view


def _scissor(view: View, lift: ScissorLift, foot: Point, angle_deg: float) -> float:
    """Draw the lift at an angle of its links, and return the height of its platform over its foot."""
    angle = math.radians(angle_deg)
    wide, rise = lift.link_length_m * math.cos(angle), lift.link_length_m * math.sin(angle)
    for stage in range(lift.stages):
        low, high = foot[1] + stage * rise, foot[1] + (stage + 1) * rise
        view.line((foot[0], low), (foot[0] + wide, high))
        view.line((foot[0] + wide, low), (foot[0], high))
    top = foot[1] + lift.stages * rise
    view.line((foot[0] - 0.02, top), (foot[0] + lift.link_length_m, top), stroke=FLOOR)
    return lift.stages * rise


def _rars_side(geometry: RarsGeometry) -> View:
    base, lift = geometry.base, geometry.lift
    radius, ahead = base.wheel_radius_m, base.wheelbase_m
    view = View("Side view, lift collapsed and extended")
    view.line((-0.15, 0.0), (ahead + 0.3, 0.0), stroke=FLOOR)
    deck = 2.0 * radius
    view.box((-0.08, deck), (ahead + 0.08, deck + 0.03), SCHEMATIC)
    view.circle((0.0, radius), radius)
    view.circle((ahead, radius), radius, SCHEMATIC)
    foot = (0.06, deck + 0.03)
    low = _scissor(view, lift, foot, lift.collapsed_angle_deg)
    high = _scissor(view, lift, foot, lift.extended_angle_deg)
    edge = foot[0] + lift.link_length_m
    view.size((foot[0], foot[1]), (foot[0], foot[1] + high), f"extended {mm(high)}", 46.0)
    view.size((edge, foot[1]), (edge, foot[1] + low), mm(low), -18.0)
    view.size((edge, foot[1] + low), (edge, foot[1] + high), f"travel {mm(highest(lift))}", -52.0)
    view.size((0.0, 0.0), (ahead, 0.0), f"wheelbase {mm(ahead)}", -30.0)
    view.size((0.0, 0.0), (0.0, radius), mm(radius), 58.0)
    view.mark((ahead, base.centre_of_gravity_height_m), "center of gravity", (10.0, 14.0))
    view.size(
        (ahead, 0.0), (ahead, base.centre_of_gravity_height_m), mm(base.centre_of_gravity_height_m), -60.0
    )
    return view


def rars(robot: Robot[RarsGeometry]) -> str:
    """Return the drawing of RARS."""
    geometry = robot.geometry
    lift = geometry.lift
    notes = (
        (
            f"Lift: {lift.stages} stages of links of {mm(lift.link_length_m)} mm, "
            f"{lift.collapsed_angle_deg:g}° to {lift.extended_angle_deg:g}°. "
            "Of the center of gravity only the height is given."
        ),
        _axes(robot),
        _sensors(robot),
        LEGEND,
    )
    return svg(robot.title, (_rars_above(geometry), _rars_side(geometry)), notes)


def rome(robot: Robot[RomeGeometry]) -> str:
    """Return the drawing of ROME's base."""
    base = robot.geometry.base
    notes = ("x ahead, y to the left; wheels at 0°, 120° and 240° from x.", _axes(robot), LEGEND)
    above, side = View("Top view"), View("Front view, against x")
    base_from_above(above, base)
    base_from_the_side(side, base)
    return svg(robot.title, (above, side), notes)


def _climber_wall(geometry: ClimberGeometry) -> View:
    base, wall = geometry.base, geometry.wall
    half, behind = base.track_m / 2.0, -wall.length_m
    view = View("View on the wall, ahead is right")
    view.line((0.0, half), (behind, 0.0), (0.0, -half), stroke=SUPPORT, closed=True)
    view.line((behind - 0.04, 0.0), (0.1, 0.0), stroke=SCHEMATIC)
    for side, name in ((1.0, "left"), (-1.0, "right")):
        view.box(
            (-base.wheel_radius_m, side * half - base.crown_radius_m),
            (base.wheel_radius_m, side * half + base.crown_radius_m),
        )
        view.text((-base.wheel_radius_m, side * half), name, (-8.0, -4.0), anchor="end")
    view.circle((behind, 0.0), 0.012, SCHEMATIC)
    view.text((behind, 0.0), "caster", (-14.0, 8.0), anchor="end")
    view.circle((0.04, 0.0), 0.008, SENSOR)
    view.text((0.04, 0.0), "joint sensor", (10.0, 8.0), color=PURPLE, anchor="start")
    for side in (1.0, -1.0):
        view.circle((-0.03, side * half), 0.006, SENSOR)
    view.text((-0.03, half), "wall switches", (0.0, 26.0), color=PURPLE)
    view.size((0.0, half), (0.0, -half), f"track {mm(base.track_m)}", 150.0)
    view.size((behind, -half), (0.0, -half), mm(wall.length_m), -30.0)
    return view


def _climber_side(geometry: ClimberGeometry) -> View:
    base, wall = geometry.base, geometry.wall
    radius, behind = base.wheel_radius_m, -wall.length_m
    view = View("Side view, the wall below")
    view.line((behind - 0.05, 0.0), (0.1, 0.0), stroke=FLOOR)
    view.box((behind, 0.02), (0.03, 0.07), SCHEMATIC)
    view.circle((0.0, radius), radius)
    view.circle((behind, 0.012), 0.012, SCHEMATIC)
    middle = (behind * 0.5, wall.mass_height_m)
    view.mark(middle, f"{wall.mass_kg:g} kg", (-12.0, 4.0), "end")
    view.size((middle[0], 0.0), middle, mm(wall.mass_height_m), 0.0)
    view.size((0.0, 0.0), (0.0, radius), f"radius {mm(radius)}", -66.0)
    view.size((behind, 0.0), (0.0, 0.0), mm(wall.length_m), -30.0)
    return view


def _climber_tank(geometry: ClimberGeometry) -> View:
    base, radius, half = geometry.base, geometry.tank.radius_m, geometry.base.track_m / 2.0
    view = View("Along the tank's axis")
    reach = 1.6 * half / radius
    view.arc((0.0, -radius), radius, math.pi / 2.0 - reach, math.pi / 2.0 + reach, FLOOR)
    tilt = math.asin(half / radius)
    for side in (1.0, -1.0):
        out, across = (side * math.sin(tilt), math.cos(tilt)), (math.cos(tilt), -side * math.sin(tilt))
        foot = (side * half, radius * (math.cos(tilt) - 1.0))
        width, height = base.crown_radius_m, 2.0 * base.wheel_radius_m
        corners = ((width, 0.0), (-width, 0.0), (-width, height), (width, height))
        view.line(
            *(
                (foot[0] + a * across[0] + o * out[0], foot[1] + a * across[1] + o * out[1])
                for a, o in corners
            ),
            closed=True,
        )
        hub = (foot[0] + base.wheel_radius_m * out[0], foot[1] + base.wheel_radius_m * out[1])
        view.line(hub, (0.0, base.wheel_radius_m * math.cos(tilt)), stroke=SCHEMATIC)
    view.circle((0.0, base.wheel_radius_m * math.cos(tilt)), 0.008, SENSOR)
    bound = geometry.joint.bound_deg
    view.text((0.0, base.wheel_radius_m), f"joint, limit ±{bound:g}°", (0.0, 24.0), color=VERMILION)
    view.text((0.0, 0.0), f"tank radius {mm(radius)}", (0.0, -34.0), color=BLUE)
    return view


def climber(robot: Robot[ClimberGeometry]) -> str:
    """Return the drawing of the climber."""
    geometry = robot.geometry
    base, wall, joint = geometry.base, geometry.wall, geometry.joint
    notes = (
        (
            f"Magnets: {wall.wheel_n:g} N at each wheel, {wall.caster_n:g} N at the caster. "
            f"Radius of a wheel's cross-section: {mm(base.crown_radius_m)} mm. "
            "Of the center of gravity only the height is given."
        ),
        (
            f"Joint: it turns the {joint.side} half. Path followers reverse at {joint.turns_round_deg:g}°, "
            f"speed is reduced from {joint.slow_deg:g}° and 0 at {joint.bound_deg:g}°."
        ),
        f"{_axes(robot)} Purple: sensors, their places are schematic.",
        _sensors(robot),
        LEGEND,
    )
    views = (_climber_wall(geometry), _climber_side(geometry), _climber_tank(geometry))
    return svg(robot.title, views, notes)


DRAWINGS: Final[Mapping[str, Callable[[AnyRobot], str]]] = {
    "rars": rars,
    "rome": rome,
    "rome_arm": rome_arm,
    "ar2": ar2,
    "climber": climber,
    "servo_axis": servo_axis,
}


def main() -> None:
    """Write all of them."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, drawing in DRAWINGS.items():
        (FOLDER / f"{name}.svg").write_text(drawing(find(name)), encoding="utf-8")


if __name__ == "__main__":
    main()
