"""The climbing robot in numbers: every parameter with unit and source; tanks and robots of the paper as sets.

[C] is Qualls, Canfield, Shibakov, "Kinematic control of a mobile robot performing manufacturing tasks on
non-planar surfaces", JAMRIS 10(3), 2016. It names no motors, masses, magnets or casters: those are assumed.
"""

import math
from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.parts.catalogue import RE25, MotorSheet
from fmu.parts.rows import battery_rows, motor_rows
from fmu.plants import Plant

AXES: Final = ("left", "right")

RE20: Final[MotorSheet] = {
    "resistance": 9.0,
    "inductance": 0.6e-3,
    "torque_constant": 25e-3,
    "rotor_inertia": 4e-7,
    "no_load_current": 0.02,
}
"""A motor of maxon RE20's size, 10 W, 24 V: right in the order of magnitude only."""

MOTORS: Final[tuple[Parameter, ...]] = (
    *motor_rows("wheel", "assumed, a motor of the size of maxon RE20 10 W 24 V", **RE20),
    Parameter("gear_wheel", 84.0, "1", "gear ratio", "assumed", least=0.0),
    Parameter(
        "coupled",
        0.0,
        "1",
        "1: one shaft joins both wheels, as in [C] 5; 0: each turns alone",
        "assumed, else it cannot steer",
        least=0.0,
        most=1.0,
    ),
    Parameter(
        "presliding", 0.05, "rad", "shaft angle over which dry friction builds up", "assumed", least=0.0
    ),
    Parameter(
        "gear_friction",
        0.5,
        "N.m",
        "gear's dry friction, at the wheel",
        "assumed, it holds the robot",
        least=0.0,
        tunable=True,
    ),
    *battery_rows("assumed"),
)

ROBOT: Final[tuple[Parameter, ...]] = (
    Parameter(
        "wheel_radius", 0.0254, "m", "wheel's radius r_w", "[C] 5, where it is printed as r_c", least=0.0
    ),
    Parameter(
        "crown_radius",
        0.005,
        "m",
        "radius of the wheel's cross section r_t, at most r_w",
        "assumed",
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
    Parameter("caster_distance", 0.04445, "m", "caster's pivot behind the wheels l", "[C] 5", least=0.0),
    Parameter("caster_offset", 0.012, "m", "caster's axle behind its pivot c", "assumed", least=0.0),
    Parameter("caster_radius", 0.0127, "m", "caster wheel's radius", "assumed", least=0.0),
    Parameter("caster_crown", 0.003, "m", "radius of the caster wheel's cross section", "assumed", least=0.0),
    Parameter("mass", 2.0, "kg", "whole robot", "assumed", tunable=True),
    Parameter("mass_behind", 0.015, "m", "centre of mass behind the wheels", "assumed"),
    Parameter("mass_height", 0.025, "m", "centre of mass off a plane surface", "assumed"),
    Parameter(
        "yaw_inertia", 0.005, "kg.m2", "whole robot about its normal, at the wheels' middle", "assumed"
    ),
    Parameter("wheel_inertia", 5e-5, "kg.m2", "one wheel about its axle", "assumed"),
)

JOINT: Final[tuple[Parameter, ...]] = (
    Parameter(
        "joint_side",
        1.0,
        "1",
        "half that the joint moves: 1 the left one, -1 the right one; chassis and caster are the other's",
        "[C] 2.1: the suspension is part of the left wheel's chain",
        least=-1.0,
        most=1.0,
    ),
    Parameter("joint_spring", 0.5, "N.m/rad", "joint's spring", "assumed", least=0.0),
    Parameter("joint_rest", 0.0, "rad", "joint's angle without load", "assumed"),
    Parameter("joint_damping", 0.02, "N.m.s/rad", "joint's damping", "assumed", least=0.0),
    Parameter(
        "joint_stop", math.radians(25.0), "rad", "joint's stops, both ways from flat", "assumed", least=0.0
    ),
    Parameter("stop_stiffness", 200.0, "N.m/rad", "stiffness of its stops", "assumed", least=0.0),
    Parameter("joint_sensor", math.pi / 10.0, "rad", "joint's angle for 1 V of its sensor", "assumed"),
    Parameter("joint_sensor_rest", 2.5, "V", "joint's sensor where the joint is flat", "assumed"),
)

MAGNETS: Final[tuple[Parameter, ...]] = (
    Parameter("magnet_wheel", 60.0, "N", "pull-off force of a wheel", "assumed", least=0.0, tunable=True),
    Parameter("magnet_caster", 20.0, "N", "pull-off force of the caster", "assumed", least=0.0, tunable=True),
    Parameter("magnet_reach", 0.002, "m", "gap from which no magnet holds", "assumed", least=0.0),
    Parameter(
        "wall_friction",
        0.5,
        "1",
        "friction between wheel and wall",
        "assumed",
        least=0.0,
        tunable=True,
    ),
    Parameter(
        "slip_damping",
        50.0,
        "N.s/m",
        "force beyond friction for each m/s of a sliding wheel; very large: it never slides",
        "assumed",
        least=0.0,
    ),
)

TANK: Final[tuple[Parameter, ...]] = (
    Parameter("tank_radius", 0.381, "m", "cylinder's radius r_c; very large is a plane", "[C] 5", least=0.0),
    Parameter(
        "ring_radius",
        1e12,
        "m",
        "radius of the circle that is the tank's axis: very large is a cylinder, 0 a sphere",
        "assumed",
        least=0.0,
    ),
    Parameter("gravity", 9.81, "m/s2", "standard gravity", "assumed", least=0.0),
    Parameter(
        "axis_tilt", math.pi / 2, "rad", "cylinder's axis over the horizontal", "[C] 5, a standing tank"
    ),
)

START: Final[tuple[Parameter, ...]] = (
    Parameter("start_arc", 0.0, "m", "the middle's way round the tank at the start", "assumed"),
    Parameter("start_height", 0.0, "m", "the middle's way along the axis at the start", "assumed"),
    Parameter("start_heading", math.pi / 2, "rad", "heading at the start: up the axis", "assumed"),
    Parameter(
        "start_swivel", 0.0, "rad", "caster's swivel at the start: 0 trails behind the pivot", "assumed"
    ),
    Parameter(
        "start_joint", 0.0, "rad", "joint's angle at the start, beyond that of upright wheels", "assumed"
    ),
)

PARAMETERS: Final[tuple[Parameter, ...]] = MOTORS + ROBOT + JOINT + MAGNETS + TANK + START

_VALIDATION: Final[Mapping[str, float]] = {
    "wheel_radius": 0.05,
    "crown_radius": 0.01,
    "half_track": 0.10,
    "caster_distance": 0.0875,
    "caster_offset": 0.024,
    "caster_radius": 0.025,
    "caster_crown": 0.006,
    "mass": 4.0,
    "mass_behind": 0.03,
    "mass_height": 0.05,
    "yaw_inertia": 0.04,
    "wheel_inertia": 4e-4,
    "gear_friction": 1.2,
    "magnet_wheel": 120.0,
    "magnet_caster": 40.0,
}
"""[C] 4 gives r_w and b; the rest is the laboratory's robot, twice as large (assumed)."""
RATIOS: Final[Mapping[str, float]] = {
    "ratio_7": 7.5,
    "ratio_13": 13.3,
    "ratio_15": 15.0,
    "ratio_20": 20.0,
    "ratio_500": 500.0,
    "ratio_2000": 2000.0,
    "plane": 1e6,
}
"""r_c / b. The paper's radii of 2e5, 2e2 and 0.5e2 "m" do not fit its ratios; the ratios count."""

_RE25: Final = {row.name: row.start for row in motor_rows("wheel", "assumed, maxon RE25 20 W 24 V", **RE25)}
"""A motor that carries 4 kg up a wall for ever: half the weight and the gear's friction take 1.1 A of it."""

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "lab": {},
    "validation": {**_VALIDATION, "tank_radius": 200.0},
    **{
        name: {**_VALIDATION, "tank_radius": ratio * _VALIDATION["half_track"]}
        for name, ratio in RATIOS.items()
    },
    "driven": {**_VALIDATION, "tank_radius": RATIOS["ratio_20"] * _VALIDATION["half_track"], **_RE25},
    "sphere": {"tank_radius": 1.0, "ring_radius": 0.0},
    "bend": {"tank_radius": 0.5, "ring_radius": 1.0},
}
"""The laboratory's robot on its tank ([C] 5, r_c / b = 7.5), the validation robot ([C] 4) on its tank and on
others, with larger motors on ratio 20 for missions, the laboratory's robot on a sphere and on a pipe's bend
(assumed)."""

PLANT: Final = Plant(
    "climber",
    "fmu.climber",
    PARAMETERS,
    SETS,
    robot_file={
        "geometry.base.wheel_radius_m": ("wheel_radius", 1.0),
        "geometry.base.track_m": ("half_track", 0.5),
        "geometry.base.crown_radius_m": ("crown_radius", 1.0),
        "geometry.base.coupling": ("coupled", 1.0),
        "geometry.joint.place": ("joint_side", 1.0),
        "geometry.tank.radius_m": ("tank_radius", 1.0),
        "battery.nominal_v": ("battery_emf", 1.0),
        "sensors.joint.settings.per_volt": ("joint_sensor", 1.0),
        "geometry.start.heading_deg": ("start_heading", math.pi / 180.0),
        "geometry.start.height_m": ("start_height", 1.0),
        "geometry.wall.wheel_n": ("magnet_wheel", 1.0),
        "geometry.wall.caster_n": ("magnet_caster", 1.0),
        "geometry.wall.friction": ("wall_friction", 1.0),
        "geometry.wall.mass_kg": ("mass", 1.0),
        "geometry.wall.mass_height_m": ("mass_height", 1.0),
        "axes.left.ratio": ("gear_wheel", 1.0),
        "axes.right.ratio": ("gear_wheel", 1.0),
    },
    grips=True,
)
