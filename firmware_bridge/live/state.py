"""State of a bridge as the live page shows it: JSON values, made of its newest snapshot."""

import math
from collections.abc import Mapping
from typing import Any, Final, TypeAlias

from firmware_bridge.bridge import Bridge
from firmware_bridge.drivers.driver import Feedback, Position, SetPoint, Speed
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find, robot_type_of, robots
from firmware_bridge.safety.snapshot import Tracking
from firmware_bridge.units import to_seconds

Json: TypeAlias = dict[str, Any]
Outline: TypeAlias = list[list[float]]
"""A polygon: its corners, m."""
DIGITS: Final = 6
"""Significant digits of a number on the page."""


def number(value: float | None) -> float | None:
    """Return a number for the page; None where it is none, as JSON has no NaN."""
    return float(f"{value:.{DIGITS}g}") if value is not None and math.isfinite(value) else None


def axes_of(robot: AnyRobot) -> list[Json]:
    """Return the axes as the page introduces them."""
    return [
        {"name": it.name, "title": it.title, "unit": it.unit.value, "number": it.settings.number}
        for it in robot.axes
    ]


def outline_named(name: str) -> list[Outline]:
    """Return an installed robot from above by its name; none of another one, and none by a path."""
    return outline_of(find(name)) if name in robots() else []


def outline_of(robot: AnyRobot) -> list[Outline]:
    """Return the robot from above: polygons in its own axes, m, the body first; none: an arrow."""
    drawing = robot_type_of(robot).drawing
    if drawing is None:
        return []
    return [[[round(x, DIGITS), round(y, DIGITS)] for x, y in polygon] for polygon in drawing.above(robot)]


def bridge_state(robot: AnyRobot, bridge: Bridge) -> Json:
    """Return what the bridge of a robot knows: axes, pose, command, interlocks, its operator's link."""
    seen, station = bridge.seen, bridge.operator.stations.in_control
    facts, pose = seen.facts, seen.pose
    lost = None if station is None else station.clocks.losses.share
    age = facts.now - facts.received_at
    command = {title: number(read(seen.command)) for title, read in robot_type_of(robot).numbers.items()}
    return {
        "arm": _arm(robot, bridge),
        "armed": facts.armed,
        "stopped": facts.emergency_stopped,
        "mode": facts.mode,
        "pose": [number(pose.x_m), number(pose.y_m), number(pose.heading_rad)],
        "command": command,
        "axes": [_axis(one, facts.following) for one in facts.axes.values()],
        "interlocks": [
            {"name": it.name, "reason": it.reason, "remedy": it.remedy, "since_s": to_seconds(it.since)}
            for it in bridge.interlock_events
        ],
        "margin": _margin(robot, bridge),
        "operator": {
            "station": "" if station is None else str(station.sender),
            "loss_percent": None if lost is None else number(100.0 * lost),
            "age_s": None if facts.received_at == NEVER_RECEIVED else number(to_seconds(age)),
        },
    }


def _arm(robot: AnyRobot, bridge: Bridge) -> list[list[float | None]]:
    """Return the places of an arm's joints, in the robot's axes and above the floor, m."""
    drawing = robot_type_of(robot).drawing
    if drawing is None or drawing.arm is None:
        return []
    return [[number(one) for one in point] for point in drawing.arm(robot, bridge.seen.body)]


def _margin(robot: AnyRobot, bridge: Bridge) -> Json | None:
    """Return what the robot's stand or hold has to spare; None for a robot without such a row."""
    row = robot_type_of(robot).station.margin_of(robot)
    if row is None:
        return None
    value, least = number(row.read(robot, bridge.seen)), number(row.least(robot))
    return {"value": value, "least": least, "unit": row.unit, "title": row.title}


def _axis(feedback: Feedback, following: Mapping[str, Tracking]) -> Json:
    sampled = feedback.sampled_at != NEVER_RECEIVED
    tracking = following.get(feedback.axis)
    return {
        "name": feedback.axis,
        "power": feedback.power.value,
        "state": feedback.text,
        "position": number(feedback.position) if sampled else None,
        "velocity": number(feedback.velocity) if sampled else None,
        "target": None if tracking is None else _target(tracking.set_point),
        "current_a": number(feedback.current_a),
        "temperature_c": None,
        "fault": feedback.fault,
    }


def _target(set_point: SetPoint) -> float | None:
    """Return a set-point's number: a speed, or a position; None for a stop."""
    match set_point:
        case Speed(value) | Position(value):
            return number(value)
    return None
