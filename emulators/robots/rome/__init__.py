"""ROME's base on the bench: the inputs of a mission's step, the station's messages, and the pictures.

Signs, scales and paths are written here again, not taken from the bridge, so that a mistake there is not
repeated.
"""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Final, Literal, TypeAlias

import numpy as np

from emulators.bench.bench_setup import BenchSetup, Channel, StickAxes, TwistAxes
from emulators.bench.columns import PLANAR, SIDEWAYS, Column, Curve, Panel
from emulators.bench.path_error import OFFSET
from emulators.bench.path_error import Path as FollowedPath
from emulators.bench.step import Finite, Holds, Positive, Presses, Slope, Step
from emulators.robots.rome.cases import cases
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rome.geometry import RomeGeometry
from firmware_bridge.robots.rome.motion import RomeMotion, RomeState
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import to_seconds

Rome: TypeAlias = Robot[RomeGeometry]
Seen: TypeAlias = Snapshot[RomeMotion, RomeState]
FULL_STICK: Final = 0.98
"""Share of the speed limit that a set-point has at full stick."""
BUTTONS: Final = {"emergency_stop": 4}


class RomeStep(Step):
    """The ROME operator's input at one instant; speeds and turn stay until a later step."""

    speed_mps: Annotated[Finite | None, Holds("speed")] = None
    """Ahead positive; at once, or with `ramp_mps2`."""
    ramp_mps2: Annotated[Positive | None, Slope("speed")] = None
    left_mps: Annotated[Finite | None, Holds("left")] = None
    turn_deg_s: Annotated[Finite | None, Holds("turn", lambda turn, _: math.radians(turn))] = None
    """Turn rate, to the left positive."""
    press: Annotated[Literal["emergency_stop"] | None, Presses(BUTTONS)] = None
    """Tap a button of the stick."""


def _stick(values: Mapping[str, float], robot: Rome) -> StickAxes:
    limits = robot.geometry.limits
    full = FULL_STICK * limits.speed_mps
    # MAVLink's y is to the right and its r clockwise; both are the other way here.
    return StickAxes(
        x=values["speed"] / full,
        y=-values["left"] / full,
        r=-values["turn"] / limits.turn_rate_rad_s,
    )


def _commanded_ahead(seen: Seen) -> float:
    return seen.commanded.ahead_mps


def _commanded_left(seen: Seen) -> float:
    return seen.commanded.left_mps


def _path_offset(seen: Seen) -> float:
    along = seen.command.path_s
    return math.nan if along is None else along - to_seconds(seen.facts.now)


def _ellipse(along: float, across: float) -> FollowedPath:
    """Return the paths (2.20) and (2.22): a cos 0.25 t, b sin 0.25 t."""
    return lambda seconds: (along * np.cos(0.25 * seconds), across * np.sin(0.25 * seconds))


def _line(metres: float) -> FollowedPath:
    """Return the path (2.21): t, 0."""
    return lambda seconds: (metres * seconds, 0.0 * seconds)


def _points(robot: Rome) -> FollowedPath:
    """Return the path by points, straight in between."""
    # Without points in the robot file a path that stays: `np.interp` needs one at least.
    times, x, y, _ = zip(*(robot.geometry.paths.points or ((0.0, 0.0, 0.0, 0.0),)), strict=True)
    return lambda seconds: (np.interp(seconds, times, x), np.interp(seconds, times, y))


PATHS: Final[Mapping[str, Callable[[Rome], FollowedPath]]] = {
    "circle": lambda robot: _ellipse(robot.geometry.paths.circle, robot.geometry.paths.circle),
    "line": lambda robot: _line(robot.geometry.paths.line),
    "ellipse": lambda robot: _ellipse(robot.geometry.paths.ellipse, 1.5 * robot.geometry.paths.ellipse),
    "points": _points,
}


def _remarks(robot: Rome) -> Mapping[str, str]:
    limits = robot.geometry.limits
    return {
        "max_speed_mps": f"limit {limits.speed_mps:g}",
        "max_acceleration_mps2": f"limit {limits.acceleration_mps2:g} of set-points",
    }


BENCH_SETUP: Final = BenchSetup(
    step=RomeStep,
    missions=Path(__file__).with_name("missions"),
    channels=(
        Channel("speed", lambda robot: FULL_STICK * robot.geometry.limits.speed_mps, trembles_with="speed"),
        Channel("left", lambda robot: FULL_STICK * robot.geometry.limits.speed_mps, trembles_with="left"),
        Channel("turn", lambda robot: robot.geometry.limits.turn_rate_rad_s, trembles_with="turn"),
    ),
    stick=_stick,
    twist=lambda values, _: TwistAxes(values["speed"], -values["left"], -values["turn"]),
    columns=(
        *PLANAR,
        Column(SIDEWAYS, "speed to the left", "m/s", plant="speed_sideways"),
        Column("demanded_speed_mps", "the bridge's set-point, ahead", "m/s", seen=_commanded_ahead),
        Column("demanded_left_mps", "the bridge's set-point, to the left", "m/s", seen=_commanded_left),
        Column(OFFSET, "a path follower's clock less the run's", "s", seen=_path_offset),
        Column("battery_v", "battery's terminal voltage", "V", plant="battery_voltage"),
    ),
    panels=(
        Panel(
            "Speed ahead",
            "speed [m/s]",
            (Curve("demanded_speed_mps", "set-point", step=True), Curve("speed_mps", "actual (plant)")),
            limit=lambda robot: (robot.geometry.limits.speed_mps, "m/s"),
            shaded=True,
            height=2.5,
        ),
        Panel(
            "Speed to the left",
            "speed [m/s]",
            (Curve("demanded_left_mps", "set-point", step=True), Curve("speed_left_mps", "actual (plant)")),
            shaded=True,
            height=2.5,
        ),
        Panel(
            "Turn rate, left is positive",
            "turn rate [rad/s]",
            (Curve("yaw_rate_rad_s", "actual (plant)"),),
            least=0.1,
        ),
    ),
    remarks=_remarks,
    cases=cases,
    paths=PATHS,
)
