"""ROME's base in numbers: every parameter with unit and source.

[O] is A. Seleit, "Rapid Orbital Motion Emulator (ROME)", MSc thesis, UCF, 2020. It names the kit (Nexus Robot
10013) and the wheels' angles, but no dimension, mass or motor: those are assumed.
"""

from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.parts.rows import battery_rows, motor_rows
from fmu.plants import Plant

AXES: Final = ("one", "two", "three")
"""The wheels in the order of [O] 2.2: at 0, 120 and 240 degrees."""

MOTORS: Final[tuple[Parameter, ...]] = (
    *motor_rows(
        "wheel",
        "assumed, order of magnitude of a 12 V hobby gear motor of 17 W",
        resistance=2.0,
        inductance=1.0e-3,
        torque_constant=13.0e-3,
        rotor_inertia=20e-7,
        no_load_current=0.12,
        voltage=12.0,
    ),
    Parameter("gear_wheel", 64.0, "1", "gear ratio", "assumed, gear motors of the kit", least=0.0),
    Parameter(
        "presliding", 0.05, "rad", "shaft angle over which dry friction builds up", "assumed", least=0.0
    ),
    *battery_rows("assumed", 12.0),
)

BASE: Final[tuple[Parameter, ...]] = (
    Parameter("wheel_radius", 0.05, "m", "omni wheel's radius R", "assumed; missing in [O]", least=0.0),
    Parameter(
        "wheel_distance", 0.15, "m", "wheel to the base's middle L", "assumed; missing in [O]", least=0.0
    ),
    Parameter("mass", 15.0, "kg", "base with the arm on it", "assumed; missing in [O]", tunable=True),
    Parameter("yaw_inertia", 0.25, "kg.m2", "base with the arm, about the vertical", "assumed"),
    Parameter("wheel_inertia", 2.5e-4, "kg.m2", "one wheel about its axle", "assumed"),
    Parameter("gravity", 9.81, "m/s2", "standard gravity", "assumed", least=0.0),
    Parameter(
        "roller_friction",
        0.02,
        "1",
        "rollers' dry friction over the wheel's load",
        "assumed",
        least=0.0,
        tunable=True,
    ),
    Parameter("roller_viscous", 1.0, "N.s/m", "rollers' viscous friction", "assumed", tunable=True),
    Parameter(
        "touch_down",
        0.1,
        "s",
        "in which a wheel that is put down loses its speed over the floor, to 1/e",
        "assumed: some 5 N at 0.5 m/s, within what a wheel's load of 11 N rubs",
        least=0.0,
    ),
    Parameter(
        "roller_presliding", 2e-4, "m", "way over which the rollers' friction builds up", "assumed", least=0.0
    ),
)

PARAMETERS: Final[tuple[Parameter, ...]] = MOTORS + BASE

_KIT: Final = {
    "resistance_wheel": 1.9,
    "inductance_wheel": 65e-6,
    "torque_constant_wheel": 13.4e-3,
    "rotor_inertia_wheel": 5.8e-7,
    "coulomb_wheel": 0.5 * 13.4e-3 * 0.075,
    "viscous_wheel": 0.5 * 13.4e-3 * 0.075 / ((12.0 - 1.9 * 0.075) / 13.4e-3),
    "wheel_distance": 0.16,
}
"""Assumed: the kit with optical encoders, its motors' figures from memory (a 12 V motor of 17 W with a
no-load current of 75 mA); the gear's losses are left out."""

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "kit": {**_KIT, "mass": 3.5, "yaw_inertia": 0.05},
    "kit_with_arm": _KIT,
    "light": {},
    "heavy_arm": {"mass": 45.0, "yaw_inertia": 0.9},
    "metre_scale": {"gear_wheel": 30.0},
}
"""Named bases: the kit alone, and with an arm of 11.5 kg on it (assumed); light; with an arm of the weight of
the AR2 (assumed); with faster gears for the source's own paths.

The gear of 64:1 ends at 0.7 m/s at the rim, so paths have to be driven at less than a meter to the unit.
The line (2.21) is 1 m/s, 0.87 m/s at two rims; the orbit (4.10) at 1 m/DU reaches 1.01 m/s, and some rim
all of it. The same motor behind 30:1, another gear of the same size (assumed), runs 1.5 m/s without load."""

ROBOT_FILE: Final[Mapping[str, tuple[str, float]]] = {
    "geometry.base.wheel_radius_m": ("wheel_radius", 1.0),
    "geometry.base.wheel_distance_m": ("wheel_distance", 1.0),
    **{f"axes.{wheel}.ratio": ("gear_wheel", 1.0) for wheel in ("one", "two", "three")},
}
"""One gear for all wheels: a file with different ones is refused."""

PLANT: Final = Plant("rome_base", "fmu.rome_base", PARAMETERS, SETS, ROBOT_FILE)
