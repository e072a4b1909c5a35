"""Radial deviation of a piloted robot from its path, by the plant's truth."""

import math
from collections.abc import Callable
from typing import Final, TypeAlias

import numpy as np

from emulators.bench.columns import POSE, Samples
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.paths import Path

DRIVEN_M: Final = 1.0
"""Least distance driven after settling; a robot that drove less has not followed a path."""
EVERY: Final = 5
"""Rows, so 50 ms: a swing takes seconds."""

DRIVING_MPS: Final = 0.01
WINDOW_M: Final = 2.0
"""Range of the search for the nearest place, to either side of the last one: an eight crosses itself."""

Placed: TypeAlias = Callable[[Pose], Path]


def radial_error(samples: Samples, placed: Placed, settled_after_s: float) -> float | None:
    """Return half of what lies between the largest and the least distance to the path, its sides counted, m.

    Of a circle that is half of peak to peak of the radius. It counts from when the robot has driven for so
    long; None where it has not driven a meter since.
    """
    speed = samples.column("speed_mps")
    driving = np.flatnonzero(np.abs(speed) > DRIVING_MPS)
    if not driving.size:
        return None
    x, y, heading = (samples.column(name) for name in POSE)
    path = placed(Pose(float(x[0]), float(y[0]), float(heading[0])))
    settled = np.flatnonzero(samples.seconds >= samples.seconds[driving[0]] + settled_after_s)
    # The standstill behind the end of the drive is no part of the path.
    settled = settled[settled <= driving[-1]]
    if settled.size < EVERY or float(np.hypot(np.diff(x[settled]), np.diff(y[settled])).sum()) < DRIVEN_M:
        return None
    left, along = [], None
    for row in settled[::EVERY]:
        # From the last place on: at its crossing an eight has two nearest branches.
        low, high = (-math.inf, math.inf) if along is None else (along - WINDOW_M, along + WINDOW_M)
        along, away = path.nearest((float(x[row]), float(y[row])), low, high)
        left.append(away)
    return (max(left) - min(left)) / 2.0
