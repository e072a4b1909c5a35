"""RARS that can tip over on a bench of its own: its lift up, its load on, braked or rolling."""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Final

from fmu.build import ensure
from fmu.plant import FmuPlant
from fmu.rars_tipping.interface import INPUTS, OUTPUTS
from fmu.rars_tipping.parameters import PARAMETERS, SETS

P: Final = {row.name: row.start for row in PARAMETERS}
RECTANGLE: Final = SETS["2.3.1_rectangle"]
"""The model of [R] 2.3.1: 70 kg with the wheels, x_cg = 141 mm, half width 168 mm."""
GRIPS: Final = {"floor_friction": 1.0}
BRAKED: Final = {"coulomb_left": 50.0, "coulomb_right": 50.0, "rolling_resistance": 0.0} | GRIPS
LOADS: Final = ("load_rear_left", "load_rear_right", "load_front_left", "load_front_right")
STEPS: Final = 10_000
"""In a second."""


def lift_angle(rise: float) -> float:
    """Return the lift motor's angle in rad at which the table is so far above collapsed, in m (2.16)."""
    link, collapsed = P["lift_link_length"], P["lift_collapsed_angle"]
    upright = rise / P["lift_stages"] + link * math.sin(collapsed)
    travel = link * math.cos(collapsed) - math.sqrt(link**2 - upright**2)
    return travel * 2 * math.pi * P["gear_lift"] / P["screw_pitch"]


RAISED: Final = {"angle_lift": lift_angle(1.0), "lift_payload": 10.0}
"""10 kg at 1.5 m over the floor."""


def rolling(speed: float) -> dict[str, float]:
    """Return the start of a robot that rolls straight on with this speed in m/s."""
    shaft = speed / P["wheel_radius"] * P["gear_left"]
    return {"speed_left": shaft, "speed_right": shaft}


class TippingBench:
    """The plant with its outputs by name."""

    def __init__(self, plant: FmuPlant) -> None:
        self.plant = plant

    def runs(self, seconds: float, **voltages: float) -> dict[str, float]:
        """Hold the voltages (others 0) for this time; return the outputs."""
        for place, name in enumerate(INPUTS):
            self.plant.inputs[place] = voltages.get(name.removeprefix("voltage_"), 0.0)
        for _ in range(round(seconds * STEPS)):
            self.plant.step()
        return self.now()

    def now(self) -> dict[str, float]:
        return dict(zip(OUTPUTS, self.plant.outputs, strict=True))

    def weight(self) -> float:
        """What the floor carries in N: M g cos(slope), by the parameters that it has now."""
        mass = self.plant.read("platform_mass") + 2 * self.plant.read("wheel_mass")
        mass += self.plant.read("lift_payload")
        return mass * self.plant.read("gravity") * math.cos(self.plant.read("slope"))


@contextmanager
def tipping(*given: Mapping[str, float], **more: float) -> Iterator[TippingBench]:
    """Open the plant with these parameters and start values, the later ones before the earlier."""
    values: dict[str, float] = {}
    for each in given:
        values |= each
    with FmuPlant(ensure("rars_tipping"), list(INPUTS), list(OUTPUTS), values | more) as plant:
        yield TippingBench(plant)
