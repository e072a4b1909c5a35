"""The arm AR2 on the bench: the inputs of a mission's step, the station's messages, and the pictures.

Signs, scales and courses are written here again, not taken from the bridge, so that a mistake there is not
repeated. Seen from its left side: x_m is the tool's distance ahead, y_m its height.
"""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Final, Literal, TypeAlias

import numpy as np

from emulators.bench.bench_setup import BenchSetup, Channel, StickAxes, TwistAxes
from emulators.bench.columns import Column, Curve, Floats, Panel, Samples
from emulators.bench.kepler import flight
from emulators.bench.path_error import OFFSET
from emulators.bench.path_error import Path as FollowedPath
from emulators.bench.step import Finite, Holds, Positive, Presses, Slope, Step
from emulators.robots.ar2.cases import cases
from firmware_bridge.motion.orbit import THESIS
from firmware_bridge.robot import Robot
from firmware_bridge.robots.ar2.arm import AR2
from firmware_bridge.robots.ar2.geometry import Ar2Geometry
from firmware_bridge.robots.ar2.motion import Ar2Motion, Ar2State
from firmware_bridge.robots.ar2.rules import tool
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import to_seconds

Ar2: TypeAlias = Robot[Ar2Geometry]
Seen: TypeAlias = Snapshot[Ar2Motion, Ar2State]
BUTTONS: Final = {"emergency_stop": 4}
LIFTS: Final = 8
"""The button, as MAVLink's mask has it, without which z counts for nothing."""
LOST_STEP: Final = 2.0
"""Full steps that a rotor is behind its field when it falls into another place: it has lost steps then."""
STEP_RAD: Final = math.tau / 200.0
HALVES: Final = ((1, 2, 3), (4, 5, 6))
"""Halves of the joints: a panel has room for three curves."""


class Ar2Step(Step):
    """The arm operator's input at one instant; speeds and turn stay until a later step."""

    speed_mps: Annotated[Finite | None, Holds("speed")] = None
    """Speed of the tool, ahead positive; at once, or with `ramp_mps2`."""
    ramp_mps2: Annotated[Positive | None, Slope("speed")] = None
    left_mps: Annotated[Finite | None, Holds("left")] = None
    up_mps: Annotated[Finite | None, Holds("up")] = None
    """Upward speed, by stick only."""
    turn_deg_s: Annotated[Finite | None, Holds("turn", lambda turn, _: math.radians(turn))] = None
    """Turn rate about the upright axis, to the left positive."""
    press: Annotated[Literal["emergency_stop"] | None, Presses(BUTTONS)] = None
    """Tap a button of the stick."""


def _stick(values: Mapping[str, float], robot: Ar2) -> StickAxes:
    limits = robot.geometry.limits
    up = values["up"] / limits.speed_mps
    return StickAxes(
        x=values["speed"] / limits.speed_mps,
        y=-values["left"] / limits.speed_mps,
        z=up,
        r=-values["turn"] / limits.turn_rate_rad_s,
        buttons=LIFTS if up else 0,
    )


def _believed(axis: int) -> Callable[[Seen], float]:
    """Return a reader of the tool's counted position; NaN while a joint's reference is lost."""

    def read(seen: Seen) -> float:
        lost = any(it.reference_lost for it in seen.facts.axes.values())
        return math.nan if lost else tool(seen.body)[axis]

    return read


def _commanded_speed(seen: Seen) -> float:
    return math.hypot(*seen.commanded.speed)


def _counted_speed(seen: Seen) -> float:
    state = seen.body
    return float(np.linalg.norm(AR2.jacobian(state.angles)[:3] @ state.rates))


def _path_offset(seen: Seen) -> float:
    along = seen.command.path_s
    return math.nan if along is None else along - to_seconds(seen.facts.now)


def _straight(_seen: Seen) -> float:
    """Return the heading of a side view."""
    return 0.0


def _upwards(height: Callable[[Floats, float], Floats]) -> Callable[[Ar2], FollowedPath]:
    """Return a course that keeps its place ahead; `height` takes its own seconds, and the file's meters."""

    def path(robot: Ar2) -> FollowedPath:
        return lambda seconds: (
            0.0 * seconds,
            height(np.clip(seconds, 0.0, 60.0), robot.geometry.courses.height_m),
        )

    return path


_ramp: Final = _upwards(lambda seconds, high: seconds * high / 60.0)
_sine: Final = _upwards(lambda seconds, high: high * np.sin(2.0 * np.pi * seconds / 60.0))


def _orbit_z(robot: Ar2) -> FollowedPath:
    """Return the orbit's height from its begin on; it keeps its place ahead."""
    flown, _ = flight(THESIS.place, THESIS.speed)
    scale = robot.geometry.courses.orbit_m_per_du
    return lambda seconds: (0.0 * seconds, scale * (flown(seconds)[2] - float(THESIS.place[2])))


PATHS: Final[Mapping[str, Callable[[Ar2], FollowedPath]]] = {
    "ramp": _ramp,
    "sine": _sine,
    "ramp_open": _ramp,
    "sine_pi": _sine,
    "orbit_z": _orbit_z,
}
"""(3.24) and (3.25): of 60 s, as the file has them; the height of (4.10), 1 TU in 1 s."""


def _remarks(robot: Ar2) -> Mapping[str, str]:
    limits = robot.geometry.limits
    return {
        "max_speed_mps": f"limit {limits.speed_mps:g} over a cycle; a move is faster, and then stands",
        "max_acceleration_mps2": f"limit {limits.acceleration_mps2:g} of what is demanded",
    }


def _lost(samples: Samples) -> float:
    """Return how many full steps the rotor that was furthest behind its field was behind."""
    # The lag is the plant's own: the board counts pulses, and cannot know it.
    lags = [np.abs(samples.column(f"lag_j{joint}_rad")).max(initial=0.0) for joint in range(1, 7)]
    return float(max(lags)) / STEP_RAD


BENCH_SETUP: Final = BenchSetup(
    step=Ar2Step,
    missions=Path(__file__).with_name("missions"),
    channels=(
        Channel("speed", lambda robot: robot.geometry.limits.speed_mps, trembles_with="speed"),
        Channel("left", lambda robot: robot.geometry.limits.speed_mps, trembles_with="left"),
        Channel("up", lambda robot: robot.geometry.limits.speed_mps, stick_only=True),
        Channel("turn", lambda robot: robot.geometry.limits.turn_rate_rad_s, trembles_with="turn"),
    ),
    stick=_stick,
    twist=lambda values, _: TwistAxes(values["speed"], -values["left"], -values["turn"]),
    columns=(
        Column("x_m", "tool ahead of the foot", "m", plant="tool_x"),
        Column("y_m", "tool above the floor", "m", plant="tool_z"),
        Column("heading_rad", "of a view from the side", "rad", seen=_straight),
        Column("tool_y_m", "tool, to the left", "m", plant="tool_y"),
        Column("speed_mps", "of the tool, as it is counted from cycle to cycle", "m/s", seen=_counted_speed),
        Column("tool_speed_mps", "of the tool, which swings with each step", "m/s", plant="tool_speed"),
        Column("yaw_rate_rad_s", "of the first joint", "rad/s", plant="speed_j1"),
        Column("odometry_x_m", "where the bridge counts it to be, ahead", "m", seen=_believed(0)),
        Column("odometry_y_m", "above the floor", "m", seen=_believed(2)),
        Column("odometry_heading_rad", "of a view from the side", "rad", seen=_straight),
        Column("odometry_left_m", "to the left", "m", seen=_believed(1)),
        Column("demanded_speed_mps", "the bridge's set-points of the tool", "m/s", seen=_commanded_speed),
        Column(OFFSET, "a path follower's clock less the run's", "s", seen=_path_offset),
        *(
            Column(
                f"{what}_j{joint}_{unit}",
                f"{title}, J{joint}",
                unit.replace("_s", "/s"),
                plant=f"{what}_j{joint}",
            )
            for what, title, unit in (
                ("angle", "joint's angle", "rad"),
                ("lag", "rotor behind its field", "rad"),
            )
            for joint in range(1, 7)
        ),
    ),
    panels=(
        Panel(
            "Speed of the tool",
            "speed [mm/s]",
            (
                Curve("speed_mps", "actual, by step counts", scale=1000.0),
                Curve("demanded_speed_mps", "set-point", step=True, scale=1000.0),
            ),
            limit=lambda robot: (1000.0 * robot.geometry.limits.speed_mps, "mm/s"),
            shaded=True,
            height=2.5,
        ),
        *(
            Panel(
                f"Joints {joints[0]} to {joints[-1]}",
                "angle [deg]",
                tuple(Curve(f"angle_j{it}_rad", f"J{it}", scale=math.degrees(1.0)) for it in joints),
            )
            for joints in HALVES
        ),
        *(
            Panel(
                f"Rotor lag behind the stator field, joints {joints[0]} to {joints[-1]}",
                "lag [full steps]",
                tuple(Curve(f"lag_j{it}_rad", f"J{it}", scale=1.0 / STEP_RAD) for it in joints),
                least=LOST_STEP,
            )
            for joints in HALVES
        ),
    ),
    remarks=_remarks,
    cases=cases,
    start_positions={"j2": -90.0, "j3": 90.0, "j5": 60.0},
    figures={"max_lag_full_steps": _lost},
    paths=PATHS,
)
