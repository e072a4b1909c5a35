"""A circle by the wheels' speeds on tanks of any radius: what closes on a plane does not on a tank.

Ours is the plant, Montana's equations; the independent way are eleven unknowns under nine constraints, with
contacts that are searched for by geometry.
"""

import math
from typing import Final

import numpy as np

from validation.climber.plant import Way, constrained, rolled, sizes
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

SECONDS: Final = 12.5
SPINS: Final = (4.0 * math.pi / SECONDS, 12.0 * math.pi / SECONDS)
"""rad/s: on a plane once round a circle of two half tracks."""
INSTANTS: Final = 201
HEADING: Final = 0.0
"""Round the tank: from upwards the joint runs away on a ratio of 13.3 where it turns to the left."""
TRACK: Final = 0.10
"""m, half of it: the validation robot's."""
DIAMETER: Final = 4.0 * TRACK
DRAWN: Final = (13.3, 20.0, 500.0)
RATIOS: Final = (13.3, 15.0, 20.0, 50.0, 200.0, 500.0, 2000.0)
FIGURES: Final = "The source's figures are not at hand, only what its text states about them."
RADII: Final = (
    'Its radii of 2e5, 2e2 and 0.5e2 "m" do not fit its ratios: what is driven here goes by the ratio, with '
    "wheels and caster of the validation robot."
)
OTHERS: Final = (
    "The source's cases hold the speeds of the chassis instead, not those of the wheels: see the study "
    "chassis_speeds."
)
QUICK: Final = (13.3, 20.0, 500.0)
LEAST_M: Final = 1e-6
"""Limit in m below which agreement is not required."""
SHARE: Final = 0.01
"""Share of the deviation by which both ways may differ."""


def curvature(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    ratios = QUICK if quick else RATIOS
    ours = {ratio: rolled(_on(ratio), SPINS, SECONDS, INSTANTS) for ratio in ratios}
    others = {ratio: constrained(_on(ratio), SPINS, SECONDS, INSTANTS) for ratio in ratios}
    return Findings(
        compared=tuple(row for ratio in ratios for row in _compared(ratio, ours[ratio], others[ratio])),
        plots=(
            Plot(
                "Circles on the unrolled tank",
                "way round the tank [m]",
                "way up [m]",
                tuple(
                    curve
                    for ratio in DRAWN
                    for curve in (
                        Curve(f"plant, ratio {ratio:g}", ours[ratio].arc, ours[ratio].height),
                        Curve(
                            f"constraints, ratio {ratio:g}",
                            others[ratio].arc[::10],
                            others[ratio].height[::10],
                            "points",
                        ),
                    )
                ),
                "The wheels' speeds are those of one circle on a plane. The smaller the tank, the further "
                "the end is from the begin, and the less high than wide it is.",
                equal=True,
            ),
            Plot(
                "How far a circle is from closing",
                "ratio of the tank's radius to the half track, decimal logarithm [1]",
                "distance of end and begin, decimal logarithm [m]",
                (
                    Curve("plant", np.log10(ratios), [math.log10(ours[ratio].gap()) for ratio in ratios]),
                    Curve(
                        "constraints",
                        np.log10(ratios),
                        [math.log10(others[ratio].gap()) for ratio in ratios],
                        "points",
                    ),
                ),
                "The source calls the planar model good above a ratio of some 500, and wrong from 15 "
                "down. From small to large tanks the deviation falls as the radius grows.",
            ),
        ),
        sheets=(
            Sheet(
                "In shares of the circle's diameter, 0.4 m",
                ("ratio r_c / b", "does not close by [%]", "higher than wide by [%]"),
                tuple(
                    (
                        f"{ratio:g}",
                        100.0 * ours[ratio].gap() / DIAMETER,
                        100.0 * ours[ratio].oblong() / DIAMETER,
                    )
                    for ratio in ratios
                ),
            ),
        ),
        remarks=(FIGURES, RADII, OTHERS),
    )


def _on(ratio: float) -> dict[str, float]:
    return dict(sizes("ratio_20", tank_radius=ratio * TRACK, start_heading=HEADING))


def _compared(ratio: float, ours: Way, other: Way) -> tuple[Compared, ...]:
    return tuple(
        Compared(
            f"{what}, ratio {ratio:g}",
            "mm",
            None,
            1e3 * expected,
            1e3 * found,
            1e3 * max(SHARE * abs(expected), LEAST_M),
        )
        for what, found, expected in (
            ("circle does not close by", ours.gap(), other.gap()),
            ("circle is higher than wide by", ours.oblong(), other.oblong()),
        )
    )
