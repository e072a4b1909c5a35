"""RARS by nine coordinates in numbers: those of fmu/rars that it has.

[R] is A. P. Das, PhD thesis, IIT Delhi, 2018. A steered wheel weighs and turns as a rear one (assumed).
"""

from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.parts.rows import tyre_rows
from fmu.plants import Plant
from fmu.rars import parameters as base

_ROWS: Final = {row.name: row for row in base.PARAMETERS}
_SAME: Final = (
    *("gravity", "rear_track", "wheelbase", "centre_offset", "wheel_radius", "platform_mass", "yaw_inertia"),
    *("wheel_mass", "wheel_spin_inertia", "wheel_yaw_inertia"),
)

PARAMETERS: Final[tuple[Parameter, ...]] = (
    *(_ROWS[name] for name in _SAME),
    Parameter("front_track", 0.210, "m", "c, steered wheel to steered wheel", "assumed", least=0.0),
    *tyre_rows("assumed, as fmu/rars", floor_friction=_ROWS["floor_friction"].start),
)
SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "ice": {"floor_friction": 0.0},
    "grips": {"floor_friction": 1.0},
}

PLANT: Final = Plant(
    "nine_coordinates", "validation.plants.nine_coordinates", PARAMETERS, SETS, made_of=("fmu.rars",)
)
