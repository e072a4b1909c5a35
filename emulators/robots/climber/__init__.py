"""The climber on the bench: the inputs of a mission's step, the station's messages, and the pictures.

Signs, scales and paths are written here again, not taken from the bridge, so that a mistake there is not
repeated.
"""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Final, Literal, TypeAlias

import numpy as np

from emulators.bench.bench_setup import BenchSetup
from emulators.bench.columns import Column, Curve, Panel, Samples
from emulators.bench.differential import (
    CHANNELS,
    DEMANDED,
    SPEED_PANEL,
    TURN_PANEL,
    DifferentialStep,
    remarks,
    stick,
    twist,
)
from emulators.bench.path_error import OFFSET
from emulators.bench.path_error import Path as FollowedPath
from emulators.bench.step import Presses
from emulators.robots.climber.cases import cases
from emulators.robots.climber.pictures import on_the_tank
from firmware_bridge.motion.captured import Source
from firmware_bridge.robot import Robot
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import to_seconds

Climber: TypeAlias = Robot[ClimberGeometry]
Seen: TypeAlias = Snapshot[ClimberMotion, ClimberState]
UP: Final = math.pi / 2.0
BUTTONS: Final = {"emergency_stop": 4}


class ClimberStep(DifferentialStep):
    """The climber operator's input at one instant; speed and turn stay until a later step."""

    press: Annotated[Literal["emergency_stop"] | None, Presses(BUTTONS)] = None
    """Tap a button of the stick."""


def _believed(seen: Seen) -> tuple[float, float, float]:
    """Return where the bridge believes to be on the unrolled tank.

    Odometry begins at 0, as the robot is put on: looking up. Before cameras have seen it, nothing is believed
    but that.
    """
    pose, located = seen.pose, seen.located
    if located is None:
        return -pose.y_m, pose.x_m, pose.heading_rad + UP
    if located.source is Source.UNSEEN:
        return 0.0, 0.0, UP
    return pose.x_m, pose.y_m, pose.heading_rad


def _measured_joint(seen: Seen) -> float:
    joint = seen.body.joint_rad
    return math.nan if joint is None else joint


def _path_offset(seen: Seen) -> float:
    along = seen.command.path_s
    return math.nan if along is None else along - to_seconds(seen.facts.now)


def _corners(side: float, *degrees: float) -> Callable[[Climber], FollowedPath]:
    """Return straight sides, as many times the robot file's length, from where it looks up the tank.

    `degrees` are counted to the left from up.
    """

    def path(robot: Climber) -> FollowedPath:
        length = side * (robot.geometry.paths.side_m if len(degrees) > 1 else robot.geometry.paths.length_m)
        # Complex numbers: the real part is ahead, the imaginary part to the left of the start.
        turns = np.exp(1j * np.radians(degrees)) * length
        corners = np.concatenate([[0.0], np.cumsum(turns)])
        times = np.arange(len(corners)) * length / robot.geometry.control.speed_mps
        return lambda seconds: (
            np.interp(seconds, times, corners.real),
            np.interp(seconds, times, corners.imag),
        )

    return path


def _circle(robot: Climber) -> FollowedPath:
    """Return a circle to the left that begins upwards."""
    radius, speed = robot.geometry.paths.radius_m, robot.geometry.control.speed_mps

    def path(seconds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        angle = np.clip(seconds * speed / radius, 0.0, math.tau)
        return radius * np.sin(angle), radius * (1.0 - np.cos(angle))

    return path


PATHS: Final[Mapping[str, Callable[[Climber], FollowedPath]]] = {
    "vertical": _corners(1.0, 0.0),
    "horizontal": _corners(1.0, -90.0),
    "spiral": _corners(1.0, -45.0),
    "circle": _circle,
    "triangle": _corners(1.0, 0.0, -120.0, -240.0),
    "square": _corners(1.0, 0.0, -90.0, -180.0, -270.0),
    "diamond": _corners(1.0, -45.0, 45.0, 135.0, 225.0),
}


def _closure(samples: Samples) -> float | None:
    """Return the true distance between start and end of the path follower's run; None where none drove."""
    guided = np.flatnonzero(np.isfinite(samples.column(OFFSET)))
    if not guided.size:
        return None
    # Between the first and the last row under the path follower: the operator does not count.
    begin, end = (samples[int(row)] for row in (guided[0], guided[-1]))
    return math.dist(*((row["x_m"], row["y_m"]) for row in (begin, end)))


def _fell(samples: Samples) -> float | None:
    """Return how far it has fallen; None where it has not."""
    far = float(samples.column("fall_m").max(initial=0.0))
    return far or None


def _largest_joint(samples: Samples) -> float:
    return math.degrees(float(np.abs(samples.column("joint_rad")).max(initial=0.0)))


BENCH_SETUP: Final = BenchSetup(
    step=ClimberStep,
    missions=Path(__file__).with_name("missions"),
    channels=CHANNELS,
    stick=stick,
    twist=twist,
    columns=(
        Column("x_m", "arc around the tank, to the right of an observer who looks up", "m", plant="arc"),
        Column("y_m", "height along the tank's axis", "m", plant="height"),
        Column("heading_rad", "counter-clockwise from the way round", "rad", plant="heading"),
        Column("speed_mps", "forward speed of the reference point", "m/s", plant="speed"),
        Column("yaw_rate_rad_s", "counter-clockwise", "rad/s", plant="yaw_rate"),
        Column("odometry_x_m", "where the bridge believes to be", "m", seen=lambda seen: _believed(seen)[0]),
        Column("odometry_y_m", "way up", "m", seen=lambda seen: _believed(seen)[1]),
        Column("odometry_heading_rad", "counter-clockwise", "rad", seen=lambda seen: _believed(seen)[2]),
        *DEMANDED,
        Column("joint_rad", "right half against the left", "rad", plant="joint"),
        Column("measured_joint_rad", "what its sensor reports", "rad", seen=_measured_joint),
        Column("fall_m", "how far it has fallen", "m", plant="fall"),
        Column(OFFSET, "a path follower's clock less the run's", "s", seen=_path_offset),
        Column("battery_v", "battery's terminal voltage", "V", plant="battery_voltage"),
    ),
    panels=(
        SPEED_PANEL,
        TURN_PANEL,
        Panel(
            "Joint",
            "angle [deg]",
            (Curve("joint_rad", "actual (plant)", scale=math.degrees(1.0)),),
            limit=lambda robot: (robot.geometry.joint.bound_deg, "deg"),
        ),
    ),
    remarks=remarks,
    cases=cases,
    figures={"closure_m": _closure, "max_joint_deg": _largest_joint, "fell_m": _fell},
    pictures={"tank": on_the_tank},
    well={"joint": math.radians(45.0), "wall": 1.0},
    paths=PATHS,
)
