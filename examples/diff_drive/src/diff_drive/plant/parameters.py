"""The robot in numbers: every parameter with unit and source; named sets; those from its robot file.

The robot is made up; "assumed" marks what was chosen.
"""

from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.parts.rows import battery_rows, motor_rows, tyre_rows
from fmu.plants import Plant

NAME: Final = "diff_drive"
LEFT: Final = "left"
RIGHT: Final = "right"
"""Names of the two axes, as in the robot file."""
GEAR: Final = 43.0


def _drive(axis: str) -> tuple[Parameter, ...]:
    return (
        *motor_rows(
            axis,
            "assumed, maxon RE40 150 W 24 V (148867), unchecked",
            resistance=0.299,
            inductance=8.2e-05,
            torque_constant=0.0302,
            rotor_inertia=1.42e-05,
            no_load_current=0.137,
        ),
        Parameter(f"gear_{axis}", GEAR, "1", f"gear ratio, {axis} wheel", "assumed", least=0.0),
    )


BODY: Final[tuple[Parameter, ...]] = (
    Parameter("gravity", 9.81, "m/s2", "standard gravity", "assumed", least=0.0),
    Parameter(
        "slope",
        0.0,
        "rad",
        "ramp, uphill along x of the world",
        "assumed",
        least=-1.5,
        most=1.5,
        tunable=True,
    ),
    Parameter("wheel_radius", 0.08, "m", "driven wheel's radius", "assumed", least=0.0),
    Parameter("track", 0.35, "m", "wheel to wheel", "assumed", least=0.0),
    Parameter("body_mass", 23.5, "kg", "body without its driven wheels, loaded", "assumed", tunable=True),
    Parameter("centre_offset", 0.08, "m", "axle to the body's center of mass, forwards", "assumed"),
    Parameter("centre_height", 0.175, "m", "center of mass over the floor; 0: no load transfer", "assumed"),
    Parameter("yaw_inertia", 0.7656, "kg.m2", "body about its center, vertical axis", "assumed, a box"),
    Parameter("wheel_mass", 0.75, "kg", "one driven wheel", "assumed"),
    Parameter("wheel_spin_inertia", 0.0024, "kg.m2", "driven wheel about its axle", "assumed, a disc"),
    Parameter("wheel_yaw_inertia", 0.0012, "kg.m2", "driven wheel about the vertical", "assumed, a disc"),
    Parameter(
        "rolling_resistance",
        0.005,
        "1",
        "driven wheels' rolling resistance over the load",
        "assumed",
        least=0.0,
        tunable=True,
    ),
    Parameter(
        "presliding",
        0.05,
        "rad",
        "shaft angle over which dry friction builds up",
        "assumed, 16 counts",
        least=0.0,
    ),
    *battery_rows("assumed", voltage=24.0),
)

CASTORS: Final[tuple[Parameter, ...]] = (
    Parameter("castor_ahead", 0.315, "m", "axle to the castors' pivots, forwards", "assumed"),
    Parameter("castor_track", 0.245, "m", "pivot to pivot", "assumed", least=0.0),
    Parameter("castor_trail", 0.03, "m", "pivot to contact", "assumed"),
    Parameter(
        "castor_resistance",
        0.010,
        "1",
        "castors' rolling resistance over the load",
        "assumed",
        least=0.0,
        tunable=True,
    ),
    Parameter("castor_rolling_way", 1e-4, "m", "way over which it builds up", "assumed", least=0.0),
    Parameter(
        "swivel_torque",
        0.02,
        "N.m",
        "one swivel's dry friction, the wheel's turning included",
        "assumed",
        least=0.0,
        tunable=True,
    ),
    Parameter("swivel_way", 0.02, "rad", "angle over which it builds up", "assumed", least=0.0),
)

PARAMETERS: Final[tuple[Parameter, ...]] = (
    *_drive(LEFT),
    *_drive(RIGHT),
    *BODY,
    *tyre_rows("assumed, as RARS on a dry floor", floor_friction=0.6),
    *CASTORS,
)

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "loaded": {},
    "empty": {"body_mass": 12.5, "yaw_inertia": 0.3828},
    "wet_floor": {"floor_friction": 0.25},
}

ROBOT_FILE: Final[Mapping[str, tuple[str, float]]] = {
    "geometry.base.wheel_radius_m": ("wheel_radius", 1.0),
    "geometry.base.track_m": ("track", 1.0),
    f"axes.{LEFT}.ratio": (f"gear_{LEFT}", 1.0),
    f"axes.{RIGHT}.ratio": (f"gear_{RIGHT}", 1.0),
    "battery.nominal_v": ("battery_emf", 1.0),
}
"""Path into the robot file (axes by name) -> parameter and the factor into its unit."""

PLANT: Final = Plant(NAME, "diff_drive.plant", PARAMETERS, SETS, ROBOT_FILE)
