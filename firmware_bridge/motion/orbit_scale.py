"""An orbit on a laboratory's floor: meters for distances, seconds for times, and time that is stretched.

Source: A. Seleit, MSc thesis, UCF, 2020, 2.4: 1 TU is 1 s there; how many meters 1 DU is, it does not say.

Assumed 0.4 m for 1 DU: the printed orbit then needs 2.9 by 3.5 m. Height has a scale of its own, because it
is a fortieth of the rest.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmware_bridge.motion.orbit import OrbitState

DU_KM: Final = 6378.137
"""The Earth's radius."""
MU_EARTH: Final = 398600.4418
"""km3/s2"""
TU_S: Final = math.sqrt(DU_KM**3 / MU_EARTH)
"""With these two units mu is 1: 806.81 s."""


@dataclass(frozen=True, slots=True)
class Scale:
    """Scale of an orbit in DU and TU."""

    metres_per_du: float = 0.4
    height_per_du: float = 0.4
    """m for 1 DU upwards."""
    seconds_per_tu: float = 1.0

    def on_floor(self, of: OrbitState) -> OrbitState:
        """Return place and speed in m and m/s."""
        sizes = np.array((self.metres_per_du, self.metres_per_du, self.height_per_du))
        return OrbitState(sizes * of.place, sizes / self.seconds_per_tu * of.speed)

    def slowed(
        self,
        states: Iterable[OrbitState],
        fastest_mps: float,
        hardest_mps2: float,
        rising_mps: float = math.inf,
    ) -> "Scale":
        """Return the scale in which these states ask for no more along the floor, and upwards.

        Only time is stretched. For mu = 1: the acceleration follows from the place.
        """
        stretch = self.seconds_per_tu
        for it in states:
            along = self.metres_per_du * float(np.hypot(*it.speed[:2]))
            bend = self.metres_per_du * float(np.hypot(*it.place[:2]) / np.linalg.norm(it.place) ** 3)
            rises = self.height_per_du * abs(float(it.speed[2])) / rising_mps
            # Time stretched by k divides speeds by k and accelerations by k squared, hence the root.
            stretch = max(stretch, along / fastest_mps, math.sqrt(bend / hardest_mps2), rises)
        return replace(self, seconds_per_tu=stretch)


def real_seconds(time_tu: float) -> float:
    """Return how long a time in TU is about the Earth."""
    return time_tu * TU_S
