"""The bench axis in numbers: every parameter with unit and source; named sets for other benches.

The axis is our own; "assumed" marks what was chosen.
"""

from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.parts.catalogue import RE50
from fmu.parts.rows import battery_rows, motor_rows
from fmu.plants import Plant

MOTOR: Final[tuple[Parameter, ...]] = (
    *motor_rows(
        "axis",
        "assumed, catalogue of maxon RE50 200 W 24 V (370354)",
        **RE50,
    ),
    Parameter(
        "presliding",
        0.05,
        "rad",
        "shaft angle over which dry friction builds up",
        "assumed, 16 counts",
        least=0.0,
    ),
    *battery_rows("assumed"),
)

GEAR: Final[tuple[Parameter, ...]] = (
    Parameter("gear_axis", 26.0, "1", "gear ratio", "assumed, that of RARS's wheels", least=0.0),
    Parameter(
        "backlash",
        0.02,
        "rad",
        "backlash, at the load, from flank to flank",
        "assumed, planetary gear",
        least=0.0,
    ),
    Parameter("flank_stiffness", 2000.0, "N.m/rad", "gear's stiffness, at the load", "assumed"),
    Parameter("flank_damping", 0.5, "s/rad", "flanks' damping, part of their torque per speed", "assumed"),
)

LOAD: Final[tuple[Parameter, ...]] = (
    Parameter(
        "load_inertia", 0.0875, "kg.m2", "load's inertia", "assumed, 35 kg on a wheel of 50 mm", tunable=True
    ),
    Parameter("load_coulomb", 0.2, "N.m", "load's dry friction", "assumed", least=0.0, tunable=True),
    Parameter("load_viscous", 0.01, "N.m.s/rad", "load's viscous friction", "assumed", tunable=True),
    Parameter(
        "load_presliding", 0.002, "rad", "load angle over which its friction builds up", "assumed", least=0.0
    ),
    Parameter(
        "unbalance",
        0.0,
        "N.m",
        "weight times arm of an eccentric load, hanging at angle 0",
        "assumed",
        tunable=True,
    ),
    Parameter("stop_low", -1e6, "rad", "load angle of the lower stop", "assumed, out of reach"),
    Parameter("stop_high", 1e6, "rad", "load angle of the upper stop", "assumed, out of reach"),
    Parameter("stop_stiffness", 5000.0, "N.m/rad", "stops' stiffness", "assumed"),
    Parameter("stop_damping", 0.5, "s/rad", "stops' damping, part of their torque per speed", "assumed"),
)

SWITCHES: Final[tuple[Parameter, ...]] = (
    Parameter(
        "limit_low", -1e6, "rad", "load angle below which the negative limit switch is closed", "assumed"
    ),
    Parameter(
        "limit_high", 1e6, "rad", "load angle above which the positive limit switch is closed", "assumed"
    ),
    Parameter(
        "home_low", 1e6, "rad", "load angle where the home switch's cam begins", "assumed, out of reach"
    ),
    Parameter(
        "home_high", 1e6, "rad", "load angle where the home switch's cam ends", "assumed, out of reach"
    ),
)

BRAKE: Final[tuple[Parameter, ...]] = (
    Parameter(
        "brake_torque", 2.0, "N.m", "what the closed holding brake holds, at the motor", "assumed", least=0.0
    ),
    Parameter(
        "brake_presliding",
        0.01,
        "rad",
        "shaft angle over which the brake's grip builds up",
        "assumed",
        least=0.0,
    ),
    Parameter("brake_opening", 0.002, "s", "time constant with which the grip is lost", "assumed"),
)

PARAMETERS: Final[tuple[Parameter, ...]] = MOTOR + GEAR + LOAD + SWITCHES + BRAKE

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "free": {},
    "stiff": {"backlash": 0.0},
    "between_stops": {
        "stop_low": -1.0,
        "stop_high": 2.0,
        "limit_low": -0.9,
        "limit_high": 1.9,
        "home_low": 0.4,
        "home_high": 0.6,
    },
    "hanging_arm": {"unbalance": 3.0},
}
"""Named benches: a flywheel, the same without backlash, an axis to be homed, a weight on an arm."""

PLANT: Final = Plant(
    "single_axis",
    "fmu.single_axis",
    PARAMETERS,
    SETS,
    robot_file={"axes.*.ratio": ("gear_axis", 1.0)},
    stops={"axis": ("stop_low", "stop_high")},
)
