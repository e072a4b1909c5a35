"""ROME whole in numbers: those of its base and of its arm, and where one stands on the other.

[O] is A. Seleit, "Rapid Orbital Motion Emulator (ROME)", MSc thesis, UCF, 2020, which gives none: assumed.
[A] is Annin Robotics, AR2 and AR3, for the arm.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from fmu.ar2 import parameters as arm
from fmu.export.model import Parameter
from fmu.plants import Plant
from fmu.rome_base import parameters as base

_FOOT: Final = {"mass": 5.2, "yaw_inertia": 0.06}
"""The base, with what of the arm does not turn: 3.5 and 1.7 kg."""
_STANDS: Final = "assumed; missing in [O]"

PARAMETERS: Final[tuple[Parameter, ...]] = (
    *(
        replace(row, start=_FOOT[row.name], description="base with the arm's foot", source=_STANDS)
        if row.name in _FOOT
        else row
        for row in base.PARAMETERS
    ),
    *(row for row in arm.PARAMETERS if row.name != "gravity"),
    Parameter("foot_height", 0.15, "m", "floor to the arm's foot, at the base's middle", _STANDS, least=0.0),
    Parameter("mass_height", 0.08, "m", "floor to the middle of the base's mass", _STANDS, least=0.0),
)

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "kit": {name: value for name, value in base.SETS["kit"].items() if name not in _FOOT},
    "loaded": {**base.SETS["kit"], **_FOOT, "payload": 1.0},
    "free": {
        **arm.SETS["free"],
        **dict.fromkeys(("coulomb_wheel", "viscous_wheel", "roller_friction", "roller_viscous"), 0.0),
    },
}
"""Sets: the kit's motors and wheels; 1 kg at the tool; no friction, for tests of its energy."""

ROBOT_FILE: Final[Mapping[str, tuple[str, float]]] = {
    **{path.replace("geometry", "geometry.base"): to for path, to in base.ROBOT_FILE.items()},
    **arm.ROBOT_FILE,
    "geometry.balance.base_kg": ("mass", 1.0),
    "geometry.balance.base_height_m": ("mass_height", 1.0),
    "geometry.balance.arm_height_m": ("foot_height", 1.0),
    **{f"geometry.balance.link_kg.{joint}": (f"mass_{axis}", 1.0) for joint, axis in enumerate(arm.AXES)},
}

PLANT: Final = Plant(
    "rome_arm",
    "fmu.rome_arm",
    PARAMETERS,
    SETS,
    ROBOT_FILE,
    made_of=("fmu.ar2", "fmu.rome_base"),
    stops=arm.STOPS,
)
