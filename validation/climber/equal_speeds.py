"""Equal speeds of both wheels: it drifts off the straight line, and its joint runs away or comes back.

Ours is the plant, Montana's equations; the independent way are eleven unknowns under nine constraints.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from validation.climber.plant import LEADING, UP, Way, constrained, rolled, sizes
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

SPIN: Final = 2.0
"""rad/s of a wheel."""
SHORT_M: Final = 0.2
"""A way on which the caster may trail without the joint's reaching its stop."""
DRIFT: Final = 0.01
"""Share of the drift by which both ways may differ; and the least difference in m."""
LEAST_M: Final = 2e-8
ANGLE_DEG: Final = 0.001
SLANT: Final = math.pi / 4.0
HEADINGS: Final = {"up": UP, "at 45°": SLANT, "at 135°": 3.0 * SLANT, "round": 0.0}
TANKS: Final = {"tank of the laboratory, ratio 7.5": "lab", "ratio 20": "ratio_20"}
JOINT_STOP_DEG: Final = 25.0


@dataclass(frozen=True, slots=True)
class _Run:
    """One run, both ways."""

    name: str
    metres: float
    ours: Way
    other: Way


def equal_speeds(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    runs = [
        _run(f"{tank}, {course}, caster {way}", sizes(kind, start_heading=heading), SHORT_M, tail=tail)
        for tank, kind in TANKS.items()
        for course, heading in HEADINGS.items()
        for way, tail in (("trailing", False), ("leading", True))
        if not quick or (kind == "lab" and heading == SLANT)
    ]
    lab = sizes("lab", start_heading=SLANT)
    once_round = math.sqrt(2.0) * math.tau * lab["tank_radius"]
    spiral = _run("spiral once round the laboratory's tank, caster leading", lab, once_round, tail=True)
    drawn = [run for run in runs if "7.5" in run.name and "45" in run.name]
    return Findings(
        compared=(
            *(row for run in runs for row in _compared(run)),
            Compared(
                f"{spiral.name}: drift",
                "mm",
                None,
                1e3 * float(spiral.other.aside()[-1]),
                1e3 * float(spiral.ours.aside()[-1]),
                0.01,
            ),
        ),
        plots=(
            Plot(
                "Drift off a straight line at 45° on the laboratory's tank",
                "way [m]",
                "to the left of the line [mm]",
                tuple(curve for run in drawn for curve in _curves(run, lambda way: 1e3 * way.aside())),
                "Both wheels turn equally fast: on a plane that is a straight line.",
            ),
            Plot(
                "The joint at 45° on the laboratory's tank",
                "way [m]",
                "joint's angle [°]",
                (
                    *(curve for run in drawn for curve in _curves(run, lambda way: np.degrees(way.joint))),
                    Curve("its stop", [0.0, SHORT_M], [JOINT_STOP_DEG, JOINT_STOP_DEG], "dashed"),
                ),
                "The joint's angle is carried by the way: with the caster trailing it runs away, with the "
                "caster leading it comes back. Its stops are taken away here.",
            ),
            Plot(
                "A spiral of 45° by equal speeds, caster leading",
                "way round the tank [m]",
                "way up [m]",
                (
                    Curve("plant", spiral.ours.arc, spiral.ours.height),
                    Curve("constraints", spiral.other.arc[::20], spiral.other.height[::20], "points"),
                    Curve(
                        "straight on the unrolled tank",
                        [0.0, -once_round * math.cos(SLANT)],
                        [0.0, -once_round * math.sin(SLANT)],
                        "dashed",
                    ),
                ),
                "Once round the laboratory's tank, backwards and down.",
                equal=True,
            ),
        ),
        sheets=(
            Sheet(
                f"After {SHORT_M:g} m",
                ("case", "drift to the left [mm]", "joint at the start [°]", "joint at the end [°]"),
                tuple(
                    (
                        run.name,
                        1e3 * float(run.ours.aside()[-1]),
                        math.degrees(run.ours.joint[0]),
                        math.degrees(run.ours.joint[-1]),
                    )
                    for run in runs
                ),
            ),
        ),
        remarks=(
            "Upwards, too, it drifts a little: the joint leans one wheel more than the other.",
            "Nothing pulls at the robot here: how it slides under its weight is the closed loops' matter.",
        ),
    )


def _run(name: str, parameters: Mapping[str, float], metres: float, *, tail: bool) -> _Run:
    """Drive so far nose first, the caster trailing, or tail first, the caster leading."""
    spin = -SPIN if tail else SPIN
    given = dict(parameters) | ({"start_swivel": LEADING} if tail else {})
    seconds = round(metres / (SPIN * given["wheel_radius"]), 2)
    instants = 1 + max(50, round(200 * metres))
    ways = (made(given, (spin, spin), seconds, instants) for made in (rolled, constrained))
    return _Run(name, metres, *ways)


def _compared(run: _Run) -> tuple[Compared, ...]:
    expected, found = (float(way.aside()[-1]) for way in (run.other, run.ours))
    leant, leans = (math.degrees(way.joint[-1]) for way in (run.other, run.ours))
    within = max(DRIFT * abs(expected), LEAST_M)
    return (
        Compared(f"{run.name}: drift after 0.2 m", "mm", None, 1e3 * expected, 1e3 * found, 1e3 * within),
        Compared(f"{run.name}: joint after 0.2 m", "°", None, leant, leans, ANGLE_DEG),
    )


def _curves(run: _Run, values: Callable[[Way], Floats]) -> tuple[Curve, Curve]:
    found, expected = values(run.ours), values(run.other)
    metres, name = np.linspace(0.0, run.metres, found.size), run.name.rpartition(", ")[2]
    return (
        Curve(f"plant, {name}", metres, found),
        Curve(f"constraints, {name}", metres[::5], expected[::5], "points"),
    )
