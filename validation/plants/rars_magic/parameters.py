"""RARS with tires by the magic formula in numbers: those of fmu/rars, and the formula's coefficients.

[R] is A. P. Das, PhD thesis, IIT Delhi, 2018; it prints the formula, and no coefficients.
"""

from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.plants import Plant
from fmu.rars import parameters as base

THROUGH: Final = "assumed: through the peak and the end of [R] (3.83)"
NEAREST: Final[Mapping[str, float]] = {"magic_b": 4.4651, "magic_c": 1.5636, "magic_e": -2.8866}
"""Of least squares over slips from 0 to 1."""

MAGIC: Final[tuple[Parameter, ...]] = (
    Parameter("magic_b", 10.6454, "1", "B, the stiffness factor", THROUGH, least=0.0),
    Parameter("magic_c", 1.7474, "1", "C, the shape factor", THROUGH, least=1.0, most=2.0),
    Parameter("magic_e", 0.5796, "1", "E, the curvature factor", THROUGH, most=1.0),
)
PARAMETERS: Final[tuple[Parameter, ...]] = (*base.PARAMETERS, *MAGIC)
SETS: Final[Mapping[str, Mapping[str, float]]] = {**base.SETS, "nearest": NEAREST}

PLANT: Final = Plant(
    "rars_magic",
    "validation.plants.rars_magic",
    PARAMETERS,
    SETS,
    base.PLANT.robot_file,
    made_of=("fmu.rars",),
)
