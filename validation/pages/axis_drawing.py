"""Drawing of one axis: its travel between the ends, from above."""

import math
from typing import Final

from firmware_bridge.robot import Robot
from firmware_bridge.robots.servo_axis.geometry import AxisGeometry
from validation.pages.sheet import LIMIT, SCHEMATIC, VERMILION, View, svg

ARM_M: Final = 0.15
"""Length of the arm in the drawing; the robot file has none."""


def servo_axis(robot: Robot[AxisGeometry]) -> str:
    """Return the drawing of the axis."""
    (axis,), limits = robot.axes, robot.geometry.limits
    low, high = axis.travel or (-math.pi, math.pi)
    view = View("Top view: position 0, and both ends of the travel")
    view.arc((0.0, 0.0), ARM_M, low, high, LIMIT)
    for angle, stroke in ((low, LIMIT), (high, LIMIT)):
        end = (ARM_M * math.cos(angle), ARM_M * math.sin(angle))
        view.line((0.0, 0.0), end, stroke=stroke)
        view.text(end, f"{angle:g} {axis.unit}", (12.0, 4.0), color=VERMILION, anchor="start")
    view.line((0.0, 0.0), (ARM_M, 0.0))
    view.circle((0.0, 0.0), 0.01)
    view.line((-0.05, 0.0), (0.0, 0.0), stroke=SCHEMATIC)
    notes = (
        (
            f"Limits: {limits.speed:g} {axis.unit}/s, {limits.acceleration:g} {axis.unit}/s2. "
            f"Gear: {axis.ratio:g} rad of the motor for 1 {axis.unit}."
        ),
        f"Axis: {axis.title} ({axis.settings.address}). The arm's length is schematic. Red: limit.",
    )
    return svg(robot.title, (view,), notes)
