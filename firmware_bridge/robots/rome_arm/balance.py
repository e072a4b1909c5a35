"""The common center of gravity, and its distance inside the wheels' triangle.

The wheels touch the floor at 0, 120 and 240 degrees; the arm stands at the base's middle (A. Seleit, MSc
thesis, UCF, 2020). At rest the robot stands as long as its center of gravity is above their triangle; one
that accelerates by a has it, as the floor feels it, a h / g further back.
"""

from typing import Final, NamedTuple

import numpy as np

from firmware_bridge.motion.omni import ANGLES
from firmware_bridge.robots.ar2.arm import AR2
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.units import STANDARD_GRAVITY

SIDES: Final = tuple((-float(np.cos(angle)), -float(np.sin(angle))) for angle in ANGLES)
"""Outward direction of each side of the triangle: opposite to a wheel."""
INRADIUS: Final = 0.5
"""From the middle to a side, as a share of the way to a wheel."""


class Balance(NamedTuple):
    """The center of gravity in the base's frame, and its room."""

    x_m: float
    y_m: float
    height_m: float
    room_m: float
    """To the nearest side of the triangle; below 0 the robot tips."""

    def gentlest(self, margin_m: float) -> float:
        """Return the acceleration, m/s2, that uses up all the room but `margin_m`; not below 0."""
        # Accelerating by a shifts the centre of gravity back by a h / g: solved for a.
        return max(0.0, self.room_m - margin_m) * STANDARD_GRAVITY / self.height_m


def balance(geometry: RomeArmGeometry, angles: tuple[float, ...]) -> Balance:
    """Return the center of gravity for the joints' angles, rad."""
    table = geometry.balance
    places = np.array([frame[:3, 3] for frame in AR2.frames(angles)])
    middles = (places[1:] + places[:-1]) / 2.0 + np.array((0.0, 0.0, table.arm_height_m))
    links = np.array(table.link_kg)
    total = table.base_kg + float(links.sum())
    summed = links @ middles + np.array((0.0, 0.0, table.base_kg * table.base_height_m))
    x, y, height = (float(it) / total for it in summed)
    side = INRADIUS * geometry.base.base.wheel_distance_m
    # The room to a side is measured along its outward direction; the nearest side counts.
    return Balance(x, y, height, min(side - x * out_x - y * out_y for out_x, out_y in SIDES))
