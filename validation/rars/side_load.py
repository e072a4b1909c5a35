"""A line of 2 m whose odometry is off, and a load aside: [R] 4.2.2, Fig. 4.12-4.15.

Printed: the odometry's path ends 50 mm aside and 300 mm too long, one motor is loaded more, as the battery is
on one side. Friction as low as would slip 13 % is far below the floor's, so a calibration is assumed: wheels
that roll on radii 13 % below the robot file's, 0.76 % apart. Ours is the bridge's odometry, and the whole
chain on the plant that can tip; the independent ways are an arc's closed form, and the balance of moments.
"""

import math
from functools import cache
from typing import Final

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import Samples
from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot_types import find
from validation.rars.plant import P
from validation.studies.chain import driven
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

WAY_M: Final = 2.0
TOO_LONG_M: Final = 0.300
ASIDE_M: Final = 0.050
FILE_RIM: Final = P["wheel_radius"]
ROLLS: Final = 0.0435
"""m: radius on which the wheels are assumed to roll."""
APART: Final = 0.0076
TRACK: Final = P["rear_track"]
FRONT_TRACK: Final = 0.210
LOAD_ASIDE_M: Final = 0.020
MASS: Final = P["platform_mass"] + 2.0 * P["wheel_mass"]
PAYLOAD_KG: Final = 10.0
LINE: Final = """
title = "Line of 2 m, 0 to 240 mm/s at 24 mm/s2 and back"
source = "A. P. Das, PhD thesis, IIT Delhi, 2018, 4.2.2"
duration_s = 27.0
step = [
  { at_s = 0.0, title = "confirm the positions", zero = { steering = 0.0, lift = 0.0 } },
  { at_s = 3.0, title = "arm", arm = true },
  { at_s = 4.0, title = "accelerate", speed_mps = 0.24, ramp_mps2 = 0.024 },
  { at_s = 13.129, title = "brake as gently", speed_mps = 0.0, ramp_mps2 = 0.024 },
]
"""
DRIVES: Final = {
    "as the robot file has it": ("rars", {}),
    "wheels roll on 43.5 mm, 0.76 % apart": (
        "rars",
        {
            "wheel_radius": ROLLS,
            "gear_left": P["gear_left"] * (1.0 + APART / 2.0),
            "gear_right": P["gear_right"] * (1.0 - APART / 2.0),
        },
    ),
    "10 kg in the middle": ("rars_tipping", {"lift_payload": PAYLOAD_KG}),
    "10 kg aside, 161 mm to the left": (
        "rars_tipping",
        {"lift_payload": PAYLOAD_KG, "payload_left": 0.161},
    ),
}


ODOMETRY: Final = ("odometry_x_m", "odometry_y_m")
TRUTH: Final = ("x_m", "y_m")
STEADY_S: Final = (10.0, 13.0)
"""Where currents are averaged: at 0.2 m/s and still gaining."""
WHY: Final = "the radii follow from both printed numbers; the difference is the curve's second order"


def believed() -> Pose:
    """Return where the odometry ends while the robot rolls straight on for 2 m by the assumed radii."""
    ways = [WAY_M / ROLLS / (1.0 + sign * APART / 2.0) * FILE_RIM for sign in (1.0, -1.0)]
    pose, steps = Pose(0.0, 0.0, 0.0), 1000
    for _ in range(steps):
        pose = moved(pose, ways[0] / steps, ways[1] / steps, TRACK)
    return pose


def arc_end() -> tuple[float, float]:
    """Return the same by one arc: its length by the mean radius, its turn by the difference."""
    length = WAY_M / ROLLS * FILE_RIM
    turn = length * APART / TRACK
    return length * math.sin(turn) / turn, length * (1.0 - math.cos(turn)) / turn


def by_balance(aside_m: float) -> tuple[float, float, float]:
    """Return the moment in N.m of a mass centre aside, and by how much it loads a rear and a front wheel, N.

    Each axle is assumed to bear half of it.
    """
    moment = MASS * P["gravity"] * aside_m
    return moment, moment / 2.0 / TRACK, moment / 2.0 / FRONT_TRACK


@cache
def driven_line(name: str) -> Samples:
    """Return the samples of the line through the whole chain."""
    robot = find("rars")
    fmu, parameters = DRIVES[name]
    plant = robot.plant.model_copy(update={"fmu": fmu, "parameters": parameters})
    robot = robot.model_copy(update={"plant": plant})
    mission = missions.parse(LINE, "line of 2 m", robot, bench_setup_of(robot))
    return driven(robot, mission).samples


def side_load(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study; a quick one is the same."""
    del quick
    end, (x, y) = believed(), arc_end()
    return Findings(
        compared=(
            Compared(
                "odometry too long, radii assumed",
                "mm",
                1e3 * TOO_LONG_M,
                1e3 * (x - WAY_M),
                1e3 * (end.x_m - WAY_M),
                0.1,
                WHY,
            ),
            Compared("odometry aside, radii assumed", "mm", 1e3 * ASIDE_M, 1e3 * y, 1e3 * end.y_m, 0.1, WHY),
        ),
        plots=(
            Plot(
                "What the odometry makes of a line, and where the robot is",
                "x [m]",
                "y [mm]",
                tuple(
                    Curve(f"{what}, {name}", *_path(driven_line(name), columns))
                    for name in list(DRIVES)[:2]
                    for what, columns in (("odometry", ODOMETRY), ("plant", TRUTH))
                ),
                "Through the whole chain: its wheels are driven at one speed, so they slip rather than turn "
                "apart, and little of the 50 mm is seen.",
            ),
        ),
        sheets=(
            Sheet(
                "The line through the whole chain",
                ("drive", "odometry too long [mm]", "aside [mm]", "left motor [A]", "right motor [A]"),
                tuple((name, *_off(driven_line(name))) for name in DRIVES),
            ),
            Sheet(
                "A mass centre 20 mm aside loads its wheels so, each axle half (assumed)",
                ("moment [N.m]", "each rear wheel [N]", "each front wheel [N]"),
                (by_balance(LOAD_ASIDE_M),),
            ),
        ),
        remarks=(
            (
                "13 % of slip would take 104 N of drag at mu 0.3; no flat floor gives that. The radii are "
                "assumed, as is which side bears more: the thesis's battery is on one."
            ),
        ),
    )


def _path(samples: Samples, columns: tuple[str, str]) -> tuple[Floats, Floats]:
    x, y = (samples.column(name)[::10] for name in columns)
    known = np.isfinite(x)
    return x[known], 1e3 * y[known]


def _off(samples: Samples) -> tuple[float, float, float, float]:
    """Return odometry less plant at the end, mm, and both motors' mean currents, A."""
    ends = {name: float(samples.column(name)[-1]) for name in (*ODOMETRY, *TRUTH)}
    at = samples.seconds
    steady = (at > STEADY_S[0]) & (at < STEADY_S[1])
    left, right = (float(np.mean(samples.column(f"current_{side}_a")[steady])) for side in ("left", "right"))
    long, aside = (1e3 * (ends[it] - ends[true]) for it, true in zip(ODOMETRY, TRUTH, strict=True))
    return long, aside, left, right
