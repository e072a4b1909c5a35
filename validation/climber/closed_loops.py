"""Triangle, square and diamond through the whole chain: from the path follower to CANopen and the plant.

The chain is path follower, gate, guard, CANopen, two drives, the plant. The reference is the path itself, as
geometry draws it, at the same instant. And the robot's true path is compared with the constraints' solution
under the speeds at which the plant's motors turned.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import Samples
from emulators.bench.operator import ScriptedOperator
from emulators.bench.path_error import Followed, PathError, path_error
from emulators.rig import Rig
from emulators.robots.climber import PATHS
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds
from validation.climber.constraints import Robot
from validation.climber.plant import Way, sizes
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

LOOPS: Final = ("square", "triangle", "diamond")
CAMERAS: Final = "climber+cameras"
ODOMETRY: Final = "climber"
PATH_MM: Final = 20.0
CLOSURE_MM: Final = 1.0
STEP_S: Final = 0.05
ROLLED_MM: Final = 2.0
"""Allowed distance of the plant, which carries weight, from the constraints' solution at its end."""
JOINT_DEG: Final = 0.02
FIGURES: Final = (
    "The source's figures of its loops are not at hand; it prints no size, speed or gain: 1 m of side and "
    "0.05 m/s are assumed."
)


@dataclass(frozen=True, slots=True)
class _Driven:
    """A loop that was driven."""

    robot: str
    loop: str
    samples: Samples
    path: PathError
    closure_mm: float
    joint_deg: float


def closed_loops(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    runs = [_driven(CAMERAS, loop) for loop in (LOOPS[1:2] if quick else LOOPS)]
    runs += [] if quick else [_driven(ODOMETRY, loop) for loop in LOOPS]
    followed = [run for run in runs if run.robot == CAMERAS]
    return Findings(
        compared=tuple(row for run in followed for row in _compared(run)),
        plots=tuple(
            Plot(
                f"The {run.loop}, by captured pose",
                "way round the tank [m]",
                "way up [m]",
                (
                    Curve("plant", run.samples.column("x_m"), run.samples.column("y_m")),
                    Curve("path", *_path(run.loop), "dashed"),
                ),
                f"On the unrolled tank of ratio 20. Furthest from where it shall be: {_far_mm(run):.1f} mm.",
                equal=True,
            )
            for run in followed
        ),
        sheets=(
            Sheet(
                "All loops",
                ("robot", "loop", "from the path at most [mm]", "closure [mm]", "joint at most [°]"),
                tuple((run.robot, run.loop, _far_mm(run), run.closure_mm, run.joint_deg) for run in runs),
            ),
        ),
        remarks=(FIGURES,),
    )


def _driven(name: str, loop: str) -> _Driven:
    robot = find(name)
    bench_setup = bench_setup_of(robot)
    mission = missions.find(loop, robot, bench_setup)
    operator = ScriptedOperator(robot, bench_setup, mission, np.random.default_rng(0))
    rig = Rig(robot, bench_setup, operator)
    try:
        rig.run(from_seconds(mission.duration_s))
        samples = rig.samples
        begin = next(step.at_s for step in mission.step if step.path_follower)
        path = path_error(samples, [Followed(begin, PATHS[loop](robot))], 0.0)
        numbers = {key: figure(samples) for key, figure in bench_setup.figures.items()}
    finally:
        rig.finish()
    return _Driven(
        name, loop, samples, path, 1e3 * (numbers["closure_m"] or 0.0), numbers["max_joint_deg"] or 0.0
    )


def _compared(run: _Driven) -> tuple[Compared, ...]:
    rolled = _constrained(run.samples)
    x, y = run.samples.column("x_m"), run.samples.column("y_m")
    off = math.hypot(
        rolled.arc[-1] - rolled.arc[0] - x[-1] + x[0], rolled.height[-1] - rolled.height[0] - y[-1] + y[0]
    )
    return (
        Compared(f"{run.loop}: furthest from the path", "mm", None, 0.0, _far_mm(run), PATH_MM),
        Compared(f"{run.loop}: closure", "mm", None, 0.0, run.closure_mm, CLOSURE_MM),
        Compared(f"{run.loop}: end, from where constraints see it", "mm", None, 0.0, 1e3 * off, ROLLED_MM),
        Compared(
            f"{run.loop}: joint at most",
            "°",
            None,
            math.degrees(float(np.abs(rolled.joint).max())),
            run.joint_deg,
            JOINT_DEG,
        ),
    )


def _constrained(samples: Samples) -> Way:
    """Return the way by the contacts' constraints, under the speeds of the plant's motors."""
    given = sizes("driven")
    seconds = samples.seconds - samples.seconds[0]
    left, right = (
        samples.column(f"motor_speed_{side}_rad_s") / given["gear_wheel"] for side in ("left", "right")
    )
    robot = Robot.standing(given, given["start_heading"], given["start_swivel"])
    ways = robot.driven(
        lambda t: float(np.interp(t, seconds, left)),
        lambda t: float(np.interp(t, seconds, right)),
        float(seconds[-1]),
        STEP_S,
    )
    return Way.of([one.readings() for one in ways], given["tank_radius"])


def _far_mm(run: _Driven) -> float:
    return math.nan if run.path.same_instant is None else 1e3 * run.path.same_instant


def _path(loop: str) -> tuple[Floats, Floats]:
    """Return the loop as it is drawn: round the tank to the right, up."""
    ahead, left = PATHS[loop](find(CAMERAS))(np.linspace(0.0, 100.0, 2001))
    return -left, ahead
