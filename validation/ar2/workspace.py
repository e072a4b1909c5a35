"""Places that the arm's tool reaches: at random joint angles, by closed form, and near its first axis.

Ours are the product's links, joint by joint. The independent way is the arm as one upright plane that turns
about the first axis: the wrist bends the tool in it, and out of it.
"""

import math
from typing import Final, NamedTuple

import numpy as np

from firmware_bridge.robots.ar2.arm import AR2
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Plot

UPPER_M: Final = 0.305
FORE_M: Final = 0.22263
SHOULDER_M: Final = 0.0642
HIGH_M: Final = 0.16977
TOOL_M: Final = 0.03625
LEAST_DEG: Final = np.array((-170.0, -132.0, 1.0, -165.0, -105.0, -155.0))
MOST_DEG: Final = np.array((170.0, 0.0, 141.0, 165.0, 105.0, 155.0))
"""Lengths and limits of the AR2, written here again (Annin Robotics)."""
SHOWN: Final = 2000
"""Places of the tool in the pictures."""
MANY: Final = 20_000
LOW_M: Final = 0.45
"""Up to this height the tool stays away from the first axis; above it it crosses it."""
BAND_M: Final = 0.1
GRID: Final = (67, 71, 12, 22)
"""Angles of the joints 2 to 5 on the grid, both ends included."""


class Random(NamedTuple):
    """Joint angles at random within their limits, rad, and the tool's places, m."""

    angles: Floats
    places: Floats

    @property
    def away(self) -> Floats:
        """Distances from the first axis, m."""
        return np.asarray(np.hypot(self.places[:, 0], self.places[:, 1]))


def random_places(count: int, seed: int = 0) -> Random:
    """Return so many places of the tool by the product's links; each joint's angle is evenly spread."""
    least, most = np.array(AR2.least), np.array(AR2.most)
    angles = least + (most - least) * np.random.default_rng(seed).random((count, 6))
    return Random(angles, np.array([AR2.pose(each)[:3, 3] for each in angles]))


def closed_form(angles: Floats) -> Floats:
    """Return the tool's places for joint angles, rad, a row each: x, y, z in m."""
    first, shoulder, elbow, roll, bend, _ = angles.T
    down = shoulder + elbow
    along, across = np.cos(bend), np.sin(bend) * np.cos(roll)
    away = SHOULDER_M + UPPER_M * np.cos(shoulder) + FORE_M * np.cos(down)
    away = away + TOOL_M * (along * np.cos(down) - across * np.sin(down))
    up = HIGH_M - UPPER_M * np.sin(shoulder) - FORE_M * np.sin(down)
    up = up - TOOL_M * (along * np.sin(down) + across * np.cos(down))
    aside = -TOOL_M * np.sin(bend) * np.sin(roll)
    return np.column_stack(
        (
            np.cos(first) * away - np.sin(first) * aside,
            np.sin(first) * away + np.cos(first) * aside,
            up,
        )
    )


def stretched_m() -> float:
    """Return the tool's greatest distance from the first axis: the elbow as straight as it gets."""
    elbow = math.radians(float(LEAST_DEG[2]))
    reach = math.sqrt(UPPER_M**2 + FORE_M**2 + 2.0 * UPPER_M * FORE_M * math.cos(elbow))
    return SHOULDER_M + reach + TOOL_M


def stretched_by_links_m() -> float:
    """Return the same by the product's links: joints 2 and 5 turned until shoulder and tool are in line."""
    elbow = AR2.least[2]
    # Law of sines in the triangle of shoulder, elbow and wrist.
    reach = stretched_m() - SHOULDER_M - TOOL_M
    behind = math.asin(FORE_M * math.sin(elbow) / reach)
    return float(AR2.pose((0.0, -behind, elbow, 0.0, behind - elbow, 0.0))[0, 3])


def least_away_m(places: Floats, low: float) -> float:
    """Return the least distance from the first axis, m, of places in a band of heights; NaN for none."""
    inside = (places[:, 2] >= low) & (places[:, 2] < low + BAND_M)
    if not inside.any():
        return math.nan
    return float(np.hypot(places[inside, 0], places[inside, 1]).min())


def grid_places() -> Floats:
    """Return the places on a grid of the joints 2 to 5, by closed form: the first one only turns them."""
    least, most = np.radians(LEAST_DEG), np.radians(MOST_DEG)
    spans = [np.linspace(least[it], most[it], count) for it, count in zip(range(1, 5), GRID, strict=True)]
    shoulder, elbow, roll, bend = (it.ravel() for it in np.meshgrid(*spans, indexing="ij"))
    still = np.zeros_like(shoulder)
    return closed_form(np.column_stack((still, shoulder, elbow, roll, bend, still)))


def compared(reached: Random) -> tuple[Compared, ...]:
    """Return the rows of the workspace in the study."""
    low, every = reached.places[:, 2] < LOW_M, grid_places()
    below = every[every[:, 2] < LOW_M]
    apart = np.abs(closed_form(reached.angles) - reached.places).max()
    return (
        Compared(
            "forward kinematics: furthest from its closed form", "mm", None, 0.0, 1e3 * float(apart), 1e-9
        ),
        Compared(
            "tool's reach from the first axis, elbow at its limit of 1 degree",
            "mm",
            None,
            1e3 * stretched_m(),
            1e3 * stretched_by_links_m(),
            1e-6,
        ),
        Compared(
            "furthest random place from the first axis",
            "mm",
            None,
            1e3 * stretched_m(),
            1e3 * float(reached.away.max()),
            5.0,
            "20,000 random places come near to it, and not beyond",
        ),
        Compared(
            f"least distance from the first axis, tool below {LOW_M:g} m",
            "mm",
            None,
            1e3 * float(np.hypot(below[:, 0], below[:, 1]).min()),
            1e3 * float(reached.away[low].min()),
            15.0,
            "a grid of joint angles comes nearer than 20,000 random places",
        ),
    )


def by_height(reached: Random) -> tuple[tuple[str | float, ...], ...]:
    """Return heights and the least distances from the first axis there, mm: at random, and on the grid."""
    grid, lows = grid_places(), [round(0.1 * it, 1) for it in range(-1, 8)]
    return tuple(
        (
            f"{low:g} to {low + BAND_M:g}",
            1e3 * least_away_m(reached.places, low),
            1e3 * least_away_m(grid, low),
        )
        for low in lows
    )


def plots(reached: Random) -> tuple[Plot, ...]:
    """Return the tool's places from above and from the side, Fig. 3.3."""
    x, y, z = (1e3 * it for it in reached.places[:SHOWN].T)
    low = z < 1e3 * LOW_M
    caption = "Fig. 3.3: 2,000 random joint angles within their limits, by forward kinematics"
    return (
        Plot(
            "Workspace from above",
            "ahead [mm]",
            "to the left [mm]",
            (
                Curve(f"tool above {LOW_M:g} m", x[~low], y[~low], "points"),
                Curve(f"tool below {LOW_M:g} m", x[low], y[low], "points"),
            ),
            f"{caption}; below {LOW_M:g} m the middle stays empty.",
            equal=True,
        ),
        Plot(
            "Workspace from the side",
            "ahead [mm]",
            "above the floor [mm]",
            (Curve("", x, z, "points"),),
            f"{caption}; the first axis is at 0.",
            equal=True,
        ),
    )
