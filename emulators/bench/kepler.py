"""Flight on an orbit by its shape and Kepler's equation; mu is 1, lengths in DU, times in TU."""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from emulators.bench.columns import Floats

NEWTONS: Final = 30
"""Steps on Kepler's equation; each doubles the digits of an orbit that is not nearly a line."""


def flight(place: Floats, speed: Floats) -> tuple[Callable[[Floats], Floats], float]:
    """Return the places at times since this place and speed, a column each, and the period."""
    away = float(np.linalg.norm(place))
    # Vis-viva: the semi-major axis from distance and speed.
    axis = 1.0 / (2.0 / away - float(speed @ speed))
    # The eccentricity vector, which points to the pericenter.
    towards = float(speed @ speed) * place - float(place @ speed) * speed - place / away
    eccentricity = float(np.linalg.norm(towards))
    ahead = towards / eccentricity
    beside = np.cross(np.cross(place, speed), ahead)
    beside /= np.linalg.norm(beside)
    n = axis**-1.5
    # Of the eccentric anomaly: e sin E, e cos E.
    begin = math.atan2(float(place @ speed) / math.sqrt(axis), 1.0 - away / axis)
    mean = begin - eccentricity * math.sin(begin)

    def flown(times: Floats) -> Floats:
        anomaly = mean + n * times + eccentricity * np.sin(mean + n * times)
        for _ in range(NEWTONS):
            # Newton's step on Kepler's equation, E - e sin E = M.
            late = anomaly - eccentricity * np.sin(anomaly) - mean - n * times
            anomaly = anomaly - late / (1.0 - eccentricity * np.cos(anomaly))
        across = math.sqrt(1.0 - eccentricity**2) * np.sin(anomaly)
        found: Floats = axis * (np.outer(ahead, np.cos(anomaly) - eccentricity) + np.outer(beside, across))
        return found

    return flown, math.tau / n
