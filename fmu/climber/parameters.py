"""The climbing robot in numbers: every parameter with unit and source; tanks and robots of the paper as sets.

[C] is Qualls, Canfield, Shibakov, "Kinematic control of a mobile robot performing manufacturing tasks on
non-planar surfaces", JAMRIS 10(3), 2016. It names no motors and no masses: those are ASSUME.
"""

import math
from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.parts.catalogue import RE25
from fmu.parts.rows import battery_rows, motor_rows
from fmu.plants import Plant

AXES: Final = ("left", "right")

MOTORS: Final[tuple[Parameter, ...]] = (
    *motor_rows(
        "wheel",
        "ASSUME, catalogue of maxon RE25 20 W 24 V, unchecked",
        **RE25,
    ),
    Parameter("gear_wheel", 159.0, "1", "gear ratio", "ASSUME", least=0.0),
    Parameter(
        "presliding", 0.05, "rad", "shaft angle over which dry friction builds up", "ASSUME", least=0.0
    ),
    Parameter(
        "gear_friction",
        0.5,
        "N.m",
        "gear's dry friction, at the wheel",
        "ASSUME, it holds the robot",
        least=0.0,
        tunable=True,
    ),
    *battery_rows("ASSUME"),
)

ROBOT: Final[tuple[Parameter, ...]] = (
    Parameter(
        "wheel_radius", 0.0254, "m", "wheel's radius r_w", "[C] 5, where it is printed as r_c", least=0.0
    ),
    Parameter(
        "crown_radius",
        0.0254,
        "m",
        "radius of the wheel's cross section r_t, at most r_w",
        "ASSUME, a ball",
        least=0.0,
    ),
    Parameter(
        "half_track",
        0.0508,
        "m",
        "middle of the robot to a wheel's middle b",
        "[C] 5, 2b = 0.1016 m",
        least=0.0,
    ),
    Parameter("caster_distance", 0.04445, "m", "caster behind the wheels l", "[C] 5", least=0.0),
    Parameter("mass", 3.0, "kg", "whole robot", "ASSUME", tunable=True),
    Parameter("mass_behind", 0.02, "m", "centre of mass behind the wheels", "ASSUME"),
    Parameter("yaw_inertia", 0.012, "kg.m2", "whole robot about its normal, at the wheels' middle", "ASSUME"),
    Parameter("wheel_inertia", 5e-5, "kg.m2", "one wheel about its axle", "ASSUME"),
)

TANK: Final[tuple[Parameter, ...]] = (
    Parameter("tank_radius", 0.381, "m", "cylinder's radius r_c; very large is a plane", "[C] 5", least=0.0),
    Parameter("gravity", 9.81, "m/s2", "standard gravity", "ASSUME", least=0.0),
    Parameter(
        "axis_tilt", math.pi / 2, "rad", "cylinder's axis over the horizontal", "[C] 5, a standing tank"
    ),
    Parameter(
        "start_psi", math.pi, "rad", "both contacts' angle psi at the start: pi looks up the axis", "ASSUME"
    ),
)

PARAMETERS: Final[tuple[Parameter, ...]] = MOTORS + ROBOT + TANK

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "lab": {},
    "plane": {"tank_radius": 1e5},
    "validation": {"wheel_radius": 0.05, "crown_radius": 0.05, "half_track": 0.10, "tank_radius": 200.0},
    "ratio_20": {"tank_radius": 20 * 0.0508},
    "ratio_13": {"tank_radius": 13.3 * 0.0508},
}
"""Named cases: the lab's tank ([C] 5, r_c / b = 7.5), a plane, the validation robot ([C] 4), and cases that
[C] gives by r_c / b. Its radii of 2e5, 2e2 and 0.5e2 "m" do not fit its ratios; the ratios count."""

PLANT: Final = Plant("climber", "fmu.climber", PARAMETERS, SETS)
