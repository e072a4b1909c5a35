"""Cases 1 and 2: the chassis's speed ahead and turn rate are held, open loop, not the wheels' speeds.

The constraints give the spins of the wheels at each instant. Ours is the plant under these, Montana's
equations; the independent way are eleven unknowns under eleven equations, with contacts that are searched for
by geometry. How far wheel speeds of a plane come on the same tank is in the last column of the table.
"""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np

from validation.climber.plant import UP, Way, constrained, sizes, steered
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

SPEED: Final = 0.05
"""m/s of the chassis ahead."""
TURN: Final = 0.1
"""rad/s: with the speed a circle of 0.5 m."""
ROUND_S: Final = math.tau / TURN
INSTANTS: Final = 481
STRAIGHT_S: Final = 10.0
SLANT: Final = math.pi / 4.0
ROBOT: Final[Mapping[str, float]] = {
    "caster_distance": 0.2,
    "caster_offset": 0.025,
    "caster_radius": 0.05,
    "caster_crown": 0.01,
}
"""The robot of [C] 4 with a caster as large as its wheels, two half tracks behind them (assumed)."""
TRACK: Final = 0.10
"""m, half of it."""
MANEUVERS: Final[Mapping[str, tuple[float, float, float]]] = {
    "vertical": (UP, 0.0, STRAIGHT_S),
    "horizontal": (0.0, 0.0, STRAIGHT_S),
    "at 45°": (SLANT, 0.0, STRAIGHT_S),
    "circle": (0.0, TURN, ROUND_S),
}
"""Heading at the start, turn rate, seconds."""
RATIOS: Final = (13.3, 15.0, 20.0, 500.0, 2000.0)
QUICK: Final = (13.3, 500.0)
TURNS: Final = {"to the left": TURN, "to the right": -TURN}
SHARE: Final = 0.01
"""Share of a deviation by which both ways may differ."""
LEAST_MM: Final = 0.03
"""Or so much: an instant lies up to half a step of the plant, 0.5 ms, beside the one of the constraints."""
LEAST_DRIFT_MM: Final = 1e-4
RATIO_WITHIN: Final = 1e-5
FIGURES: Final = (
    "The source prints no speeds, sizes of the caster or starts of its maneuvers: 0.05 m/s, 0.1 rad/s and a "
    "start round the tank are assumed, and its figures are not at hand."
)
SIDES: Final = (
    "The joint is in the left wheel's chain, so circles to the left and to the right differ: to the left, at "
    "a ratio of 13.3, it does not close by a twentieth of its diameter. Its joint turns further there than "
    "our stops, which are taken away, would let it: the source names none."
)


def chassis_speeds(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    ratios = QUICK if quick else RATIOS
    maneuvers = {
        name: steered(_on(20.0, heading), (SPEED, turn), seconds, _instants(seconds))
        for name, (heading, turn, seconds) in MANEUVERS.items()
        if not quick or name == "at 45°"
    }
    circles = {
        (ratio, side): steered(_on(ratio, 0.0), (SPEED, turn), ROUND_S, INSTANTS)
        for ratio in ratios
        for side, turn in TURNS.items()
    }
    return Findings(
        compared=(
            *(_drift(name, *maneuvers[name]) for name in maneuvers if name != "circle"),
            *(row for case, ways in circles.items() for row in _circle(*case, *ways)),
        ),
        plots=(
            *(_contacts(name, ours) for name, (ours, _) in maneuvers.items()),
            Plot(
                "Circles by the chassis's speeds, to the left",
                "way round the tank [m]",
                "way up [m]",
                tuple(
                    curve
                    for (ratio, side), (ours, other) in circles.items()
                    if side == "to the left" and ratio != min(RATIOS[1:3])
                    for curve in (
                        Curve(f"plant, ratio {ratio:g}", ours.arc, ours.height),
                        Curve(f"constraints, ratio {ratio:g}", other.arc[::20], other.height[::20], "points"),
                    )
                ),
                "Case 2, Fig. 8: the smaller the tank, the more oblong the circle is, higher than wide.",
                equal=True,
            ),
        ),
        sheets=(
            Sheet(
                "Circles of 0.5 m",
                (
                    "ratio r_c / b",
                    "turn",
                    "off the circle at most [mm]",
                    "does not close by [mm]",
                    "width over height",
                    "joint at most [°]",
                    "by wheel speeds of a plane: does not close by [mm]",
                ),
                tuple(
                    (
                        f"{ratio:g}",
                        side,
                        1e3 * ours.off_circle(SPEED / TURNS[side], 0.0),
                        1e3 * ours.gap(),
                        ours.width_over_height(),
                        math.degrees(float(np.abs(ours.joint).max())),
                        1e3 * by_plane(_on(ratio, 0.0), (SPEED, TURNS[side]), ROUND_S, INSTANTS).gap(),
                    )
                    for (ratio, side), (ours, _) in circles.items()
                ),
            ),
        ),
        remarks=(FIGURES, SIDES),
    )


def by_plane(
    parameters: Mapping[str, float], twist: tuple[float, float], seconds: float, instants: int
) -> Way:
    """Return the way by the wheel speeds that make this motion on a plane, which are constant."""
    speed, turn = twist
    difference = turn * parameters["half_track"]
    spins = tuple((speed + sign * difference) / parameters["wheel_radius"] for sign in (-1.0, 1.0))
    return constrained(parameters, (spins[0], spins[1]), seconds, instants)


def _on(ratio: float, heading: float) -> Mapping[str, float]:
    return sizes("ratio_20", tank_radius=ratio * TRACK, start_heading=heading, **ROBOT)


def _instants(seconds: float) -> int:
    return 1 + round((INSTANTS - 1) * seconds / ROUND_S)


def _drift(name: str, ours: Way, other: Way) -> Compared:
    expected, found = (1e3 * float(way.aside()[-1]) for way in (other, ours))
    within = max(SHARE * abs(expected), LEAST_DRIFT_MM)
    return Compared(f"{name}, ratio 20: drift to the left", "mm", None, expected, found, within)


def _circle(ratio: float, side: str, ours: Way, other: Way) -> tuple[Compared, ...]:
    radius = SPEED / TURNS[side]
    title = f"circle {side}, ratio {ratio:g}"
    lengths = (
        ("off the circle at most", ours.off_circle(radius, 0.0), other.off_circle(radius, 0.0)),
        ("does not close by", ours.gap(), other.gap()),
    )
    return (
        *(
            Compared(
                f"{title}: {what}",
                "mm",
                None,
                1e3 * expected,
                1e3 * found,
                max(SHARE * 1e3 * expected, LEAST_MM),
            )
            for what, found, expected in lengths
        ),
        Compared(
            f"{title}: width over height",
            "1",
            None,
            other.width_over_height(),
            ours.width_over_height(),
            RATIO_WITHIN,
        ),
    )


def _contacts(name: str, way: Way) -> Plot:
    """Return the paths of all three contacts, as Fig. 7 has them."""
    feet = {"left": way.wheel(-1.0), "right": way.wheel(1.0), "caster": way.caster}
    return Plot(
        f"Contacts of wheels and caster: {name}",
        "way round the tank [m]",
        "way up [m]",
        tuple(Curve(side, arc, height) for side, (arc, height) in feet.items()),
        "Case 1, Fig. 7: a constant speed and turn rate of the chassis on ratio 20.",
        equal=True,
    )
