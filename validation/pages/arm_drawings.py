"""Drawings of the arm AR2, alone and on ROME's base, in the posture in which the bench starts."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from emulators.bench.bench_setup import bench_setup_of
from firmware_bridge.robot import AnyRobot, Robot
from firmware_bridge.robots.ar2.arm import AR2, FOREARM_M, HEIGHT_M, SHOULDER_M, TOOL_M, UPPER_ARM_M
from firmware_bridge.robots.ar2.geometry import Ar2Geometry, Workspace
from firmware_bridge.robots.rome_arm.balance import INRADIUS, SIDES, balance
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from validation.pages.base_views import base_from_above, base_from_the_side
from validation.pages.sheet import FLOOR, LIMIT, LINK, SCHEMATIC, SENSOR, Point, View, svg
from validation.pages.sheet import millimeters as mm

LEGEND: Final = (
    "Dimensions in mm, from the robot file and the arm's model. Each view has a scale of its own. "
    "Gray dashed: schematic. Red: limit. Green: support polygon."
)


def start_of(robot: AnyRobot) -> tuple[float, ...]:
    """Return the joints' angles, rad, with which a run on the bench starts."""
    given = bench_setup_of(robot).start_positions
    return tuple(math.radians(given.get(f"j{joint}", 0.0)) for joint in range(1, 7))


def _joints(angles: Sequence[float]) -> list[tuple[float, float, float]]:
    """Return the places of the arm's bends: foot, shoulder's height, shoulder, elbow, wrist, tool."""
    places = [frame[:3, 3] for frame in AR2.frames(angles)]
    bends = [places[0], np.array((0.0, 0.0, HEIGHT_M)), places[1], places[2], places[4], places[6]]
    return [(float(it[0]), float(it[1]), float(it[2])) for it in bends]


def _from_the_side(view: View, angles: Sequence[float], foot: float = 0.0) -> list[Point]:
    """Draw the arm in the plane of x and z, and return its bends."""
    bends = [(x, z + foot) for x, _, z in _joints(angles)]
    view.line(*bends, stroke=LINK)
    for joint in bends[1:5]:
        view.circle(joint, 0.012, SENSOR)
    return bends


def _from_above(view: View, angles: Sequence[float]) -> Point:
    bends = [(x, y) for x, y, _ in _joints(angles)]
    view.line(*bends, stroke=LINK)
    view.circle(bends[-1], 0.01, SENSOR)
    view.text(bends[-1], "tool", (10.0, 8.0), anchor="start")
    return bends[-1]


def _link_sizes(view: View, bends: Sequence[Point], floor: float = 0.0) -> None:
    _, shoulder_height, shoulder, elbow, wrist, tool = bends
    view.size((0.0, floor), shoulder_height, mm(HEIGHT_M), 24.0)
    view.size(shoulder_height, shoulder, mm(SHOULDER_M), -20.0)
    view.size(shoulder, elbow, f"upper arm {mm(UPPER_ARM_M)}", -48.0)
    view.size(elbow, wrist, f"forearm {mm(FOREARM_M)}", 26.0)
    view.size(wrist, tool, mm(abs(TOOL_M)), 26.0)


def _workspace(above: View, side: View, workspace: Workspace) -> None:
    """Draw the box in which the tool stays, and the cylinder out of which it stays."""
    low, high = workspace.lowest_m, workspace.highest_m
    above.box((low[0], low[1]), (high[0], high[1]), LIMIT)
    above.circle((0.0, 0.0), workspace.base_radius_m, LIMIT)
    above.size((low[0], low[1]), (high[0], low[1]), mm(high[0] - low[0]), -24.0)
    above.size((low[0], low[1]), (low[0], high[1]), mm(high[1] - low[1]), 24.0)
    above.size((0.0, 0.0), (-workspace.base_radius_m, 0.0), mm(workspace.base_radius_m), 0.0)
    # Behind the first axis the box goes on: its length is in the top view.
    back = max(low[0], -2.0 * workspace.base_radius_m)
    box = ((back, low[2]), (high[0], low[2]), (high[0], high[2]), (back, high[2]))
    side.line(*box, stroke=LIMIT)
    radius, top = workspace.base_radius_m, workspace.base_height_m
    side.box((-radius, low[2]), (radius, top), LIMIT)
    side.size((high[0], low[2]), (high[0], high[2]), f"workspace {mm(high[2] - low[2])}", -24.0)
    side.size((high[0], 0.0), (high[0], low[2]), mm(low[2]), -54.0)
    side.size((-radius, 0.0), (-radius, top), mm(top), 46.0)


def ar2(robot: Robot[Ar2Geometry]) -> str:
    """Return the drawing of the arm."""
    angles = start_of(robot)
    above, side = View("Top view"), View("Side view, start posture of the bench")
    side.line((-0.25, 0.0), (0.66, 0.0), stroke=FLOOR)
    _workspace(above, side, robot.geometry.workspace)
    above.arc((0.0, 0.0), 0.2, AR2.least[0], AR2.most[0], SCHEMATIC)
    _from_above(above, angles)
    above.text((0.0, 0.2), f"J1 {_travel(0)}", (0.0, 8.0))
    bends = _from_the_side(side, angles)
    _link_sizes(side, bends)
    side.text(bends[1], "J1", (-12.0, 8.0), anchor="end")
    side.text(bends[2], "J2", (12.0, -4.0), anchor="start")
    side.text(bends[3], "J3", (-12.0, 8.0), anchor="end")
    side.text(bends[4], "J5", (-8.0, -20.0), anchor="end")
    margin = robot.geometry.limits.joint_margin_deg
    travel = "; ".join(f"J{joint + 1} {_travel(joint)}" for joint in range(6))
    notes = (
        f"Travel of the joints: {travel}; the arm stops {margin:g}° before each end.",
        (
            "Red box: workspace of the tool, in the side view from behind the first axis. "
            "Red cylinder: the tool stays outside of it."
        ),
        LEGEND,
    )
    return svg(robot.title, (above, side), notes)


def _travel(joint: int) -> str:
    low, high = (round(math.degrees(it[joint]), 1) + 0.0 for it in (AR2.least, AR2.most))
    return f"{low:g}° to {high:g}°"


def rome_arm(robot: Robot[RomeArmGeometry]) -> str:
    """Return the drawing of the arm on its base."""
    geometry, angles = robot.geometry, start_of(robot)
    base, table = geometry.base.base, geometry.balance
    center = balance(geometry, angles)
    above, side = View("Top view"), View("Side view, start posture of the bench")
    base_from_above(above, base, sized=False)
    inner = INRADIUS * base.wheel_distance_m - table.margin_m
    # The corners of a triangle are twice as far from its middle as its sides.
    above.line(*((-2.0 * inner * x, -2.0 * inner * y) for x, y in SIDES), stroke=LIMIT, closed=True)
    above.circle((0.0, 0.0), table.tool_distance_m, LIMIT)
    _from_above(above, angles)
    above.mark((center.x_m, center.y_m), "center of gravity", (6.0, -22.0))
    above.size((0.0, 0.0), (-table.tool_distance_m, 0.0), mm(table.tool_distance_m), 0.0)
    above.size(
        (0.0, -base.wheel_distance_m),
        (base.wheel_distance_m, -base.wheel_distance_m),
        mm(base.wheel_distance_m),
        -20.0,
    )
    base_from_the_side(side, base, sized=False)
    side.box((-0.08, 2.0 * base.wheel_radius_m), (0.08, table.arm_height_m), SCHEMATIC)
    bends = _from_the_side(side, angles, table.arm_height_m)
    _link_sizes(side, bends, table.arm_height_m)
    side.mark((center.x_m, center.height_m), f"center of gravity {mm(center.height_m)}", (14.0, -20.0))
    side.size(
        (-base.wheel_distance_m, 0.0),
        (-base.wheel_distance_m, table.arm_height_m),
        f"{mm(table.arm_height_m)}",
        30.0,
    )
    side.size((bends[-1][0], 0.0), bends[-1], f"tool {mm(bends[-1][1])}", -60.0)
    side.text(bends[-1], "tool", (2.0, -18.0))
    masses = ", ".join(f"{mass:g}" for mass in table.link_kg)
    notes = (
        (
            f"Masses: base with foot {table.base_kg:g} kg, its center {mm(table.base_height_m)} mm above the "
            f"floor; links {masses} kg."
        ),
        (
            f"The center of gravity stays {mm(table.margin_m)} mm inside the support polygon (red triangle). "
            "The base drives while the tool is inside the red circle. Side view: wheels seen against x."
        ),
        LEGEND,
    )
    return svg(robot.title, (above, side), notes)
