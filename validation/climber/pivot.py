"""Turn about one wheel that stands: the reduced solution (33), as printed and corrected, and the plant.

(33) gives how high the turning wheel is over the standing one, for wheels like balls and a fixed pivot point.
So the plant's wheels are as round across as along; its standing wheel rolls a little aside all the same.
"""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np

from validation.climber.plant import UP, constrained, rolled, sizes
from validation.studies.study import Compared, Curve, Findings, Plot

SECONDS: Final = 4.0
SPINS: Final = 0.0, 1.0
SHARES: Final = {20.0: 0.04, 200.0: 0.005}
"""Shares of the track by which the plant may differ from (33) on these ratios: its standing wheel shifts."""
LOOKED_AT: Final = 0.75
"""Height of the turning wheel at the comparison, as a share of the track."""
KEPT_MM: Final = 0.001
WHY: Final = "the print lacks a factor of 2 and has the sign of a wheel inside the cylinder"


def pivot(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    rows: list[Compared] = []
    curves: list[Curve] = []
    for ratio, share in SHARES.items():
        given = _balls(ratio)
        track, tank = 2.0 * given["half_track"], given["tank_radius"]
        ours, other = (made(given, SPINS, SECONDS, 41 if quick else 161) for made in (rolled, constrained))
        (across, height), (_, expected) = ours.apart, other.apart
        at = int(np.argmin(np.abs(height - LOOKED_AT * track)))
        turn = float(across[at]) / tank
        rows += [
            Compared(
                f"height over the standing wheel, turned by {1e3 * abs(turn):.1f} mrad, ratio {ratio:g}",
                "mm",
                1e3 * printed(turn, given),
                1e3 * corrected(turn, given),
                1e3 * float(height[at]),
                1e3 * share * track,
                WHY,
            ),
            Compared(
                f"the same by the contacts' constraints, ratio {ratio:g}",
                "mm",
                None,
                1e3 * float(expected[at]),
                1e3 * float(height[at]),
                KEPT_MM,
            ),
        ]
        fine = np.linspace(0.0, float(across.max()), 60)
        curves += [
            Curve(f"plant, ratio {ratio:g}", across, height),
            Curve(
                f"(33) corrected, ratio {ratio:g}",
                fine,
                [corrected(way / tank, given) for way in fine],
                "points",
            ),
            Curve(
                f"(33) as printed, ratio {ratio:g}",
                fine,
                [printed(way / tank, given) for way in fine],
                "dashed",
            ),
        ]
    return Findings(
        compared=tuple(rows),
        plots=(
            Plot(
                "A turn about one wheel",
                "way round the tank from the standing wheel [m]",
                "height over the standing wheel [m]",
                tuple(curves),
                "On a plane it is a circle about the standing wheel; as printed, even that is an ellipse.",
                equal=True,
            ),
        ),
    )


def corrected(turn: float, given: Mapping[str, float]) -> float:
    """Return (33) as geometry gives it, m; `turn` in rad about the tank's axis."""
    return _reduced(
        turn, given, 2.0 * (given["tank_radius"] ** 2 + given["wheel_radius"] * given["tank_radius"])
    )


def printed(turn: float, given: Mapping[str, float]) -> float:
    """Return (33) as it is printed, m."""
    return _reduced(turn, given, given["tank_radius"] ** 2 - given["wheel_radius"] * given["tank_radius"])


def _reduced(turn: float, given: Mapping[str, float], squared: float) -> float:
    return math.sqrt(max(4.0 * given["half_track"] ** 2 + squared * (math.cos(turn) - 1.0), 0.0))


def _balls(ratio: float) -> Mapping[str, float]:
    """Return the laboratory's robot with wheels like balls, looking up a tank of this ratio."""
    lab = sizes("lab", start_heading=UP)
    return {**lab, "tank_radius": ratio * lab["half_track"], "crown_radius": lab["wheel_radius"]}
