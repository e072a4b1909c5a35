"""RARS on springs in numbers: those of fmu/rars, springs, and a step of the floor.

[R] is A. P. Das, PhD thesis, IIT Delhi, 2018. It prints a step of 20 mm and wheels of 100 mm, and no
stiffness, travel or damping: assumed.
"""

from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.plants import Plant
from fmu.rars import parameters as base
from fmu.rars_tipping import parameters as tipping

SPRINGS: Final[tuple[Parameter, ...]] = (
    Parameter("spring_stiffness", 2e4, "N/m", "one wheel's spring", "assumed"),
    Parameter("spring_damping", 400.0, "N.s/m", "one wheel's damper", "assumed"),
    *(row for row in tipping.PARAMETERS if row.name in {"roll_inertia", "pitch_inertia", "front_track"}),
)
STEP: Final[tuple[Parameter, ...]] = (
    Parameter("edge_x", 1.0, "m", "edge of the step, x of the world", "assumed"),
    *(
        Parameter(
            f"step_{side}",
            0.020,
            "m",
            f"height of the step under the {side} wheels",
            "[R] 2.3",
            least=0.0,
            most=0.045,
        )
        for side in ("left", "right")
    ),
)
PARAMETERS: Final[tuple[Parameter, ...]] = (*base.PARAMETERS, *SPRINGS, *STEP)
SETS: Final[Mapping[str, Mapping[str, float]]] = {
    **base.SETS,
    "level": {"step_left": 0.0, "step_right": 0.0},
    "left_only": {"step_right": 0.0},
}

PLANT: Final = Plant(
    "rars_sprung",
    "validation.plants.rars_sprung",
    PARAMETERS,
    SETS,
    base.PLANT.robot_file,
    made_of=("fmu.rars", "fmu.rars_tipping"),
)
