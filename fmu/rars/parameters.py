"""RARS in numbers: every parameter with unit, source and remark; conflicting sources as named sets.

[R] is A. P. Das, "Design and control of a tele-operated mobile platform", PhD thesis, IIT Delhi, 2018.
"assumed" marks what the thesis leaves out.
"""

import math
from collections.abc import Mapping
from typing import Final

from fmu.export.model import Parameter
from fmu.parts.catalogue import RE25, RE50
from fmu.parts.rows import battery_rows, motor_rows
from fmu.plants import Plant


def _wheel_motor(axis: str) -> tuple[Parameter, ...]:
    return motor_rows(
        axis,
        "assumed, catalogue of maxon RE50 200 W 24 V (370354); agrees with 5680 rpm of [R] 2.3.2",
        **RE50,
    )


MOTORS: Final[tuple[Parameter, ...]] = (
    *_wheel_motor("left"),
    *_wheel_motor("right"),
    *motor_rows(
        "steer",
        "assumed, catalogue of maxon RE25 20 W 24 V, unchecked",
        **RE25,
    ),
    *motor_rows(
        "lift",
        "assumed, order of magnitude of maxon RE20 10 W",
        resistance=9.0,
        inductance=0.6e-3,
        torque_constant=25e-3,
        rotor_inertia=4e-7,
        no_load_current=0.02,
    ),
    Parameter("gear_left", 26.0, "1", "gear ratio, left rear wheel", "[R] 2.3.2", least=0.0),
    Parameter("gear_right", 26.0, "1", "gear ratio, right rear wheel", "[R] 2.3.2", least=0.0),
    Parameter("gear_steer", 159.0, "1", "gear ratio to the pinion", "[R] 2.4.2", least=0.0),
    Parameter("gear_lift", 25.0, "1", "gear ratio to the screw", "[R] 2.5", least=0.0),
    Parameter(
        "presliding",
        0.05,
        "rad",
        "shaft angle over which dry friction builds up",
        "assumed, 16 counts",
        least=0.0,
    ),
)

PLATFORM: Final[tuple[Parameter, ...]] = (
    Parameter("gravity", 9.81, "m/s2", "standard gravity", "used throughout [R]", least=0.0),
    Parameter(
        "slope",
        0.0,
        "rad",
        "ramp, uphill along x of the world",
        "[R] (3.44)",
        least=-1.5,
        most=1.5,
        tunable=True,
    ),
    Parameter("wheel_radius", 0.050, "m", "rear wheel's radius r", "[R] Tab. 3.1", least=0.0),
    Parameter(
        "rear_track", 0.400, "m", "rear wheel to wheel l", "[R] Tab. 3.1; (3.78) implies 0.210", least=0.0
    ),
    Parameter("wheelbase", 0.515, "m", "rear axle to front axle w", "[R] 2.4.1", least=0.0),
    Parameter("centre_offset", 0.220, "m", "rear axle to centre of mass a", "[R] Tab. 3.1"),
    Parameter("platform_mass", 70.0, "kg", "platform without rear wheels", "[R] Tab. 3.1", tunable=True),
    Parameter(
        "yaw_inertia",
        0.53,
        "kg.m2",
        "platform about its centre of mass, vertical axis",
        "[R] Tab. 3.1, element (3,3), implausible for 70 kg; (3.78) implies 3.2",
    ),
    Parameter("wheel_mass", 0.300, "kg", "one rear wheel", "[R] Tab. 3.1; 0.35 in Tab. 3.2, 0.5 by (3.78)"),
    Parameter(
        "wheel_spin_inertia", 465e-6, "kg.m2", "rear wheel about its axle I_w", "[R] Tab. 3.1, largest"
    ),
    Parameter("wheel_yaw_inertia", 242e-6, "kg.m2", "rear wheel about the vertical H", "[R] Tab. 3.1"),
    Parameter(
        "cg_height",
        0.190,
        "m",
        "centre of mass over the floor Z_cg; 0: no load transfer",
        "[R] 2.3.1",
        least=0.0,
    ),
    *battery_rows("assumed"),
)

TYRES: Final[tuple[Parameter, ...]] = (
    Parameter(
        "floor_friction", 0.3, "1", "peak of the tyres' adhesion", "[R] 3.4.5", least=0.0, tunable=True
    ),
    Parameter("peak_slip", 0.15, "1", "slip at the peak of adhesion", "[R] (3.83)", least=0.0, most=1.0),
    Parameter(
        "friction_circle",
        1.0,
        "1",
        "1: both slips share one adhesion; 0: each its own",
        "assumed; not in [R]",
        least=0.0,
        most=1.0,
    ),
    Parameter(
        "slip_speed", 0.01, "m/s", "speed below which the slip is taken over this speed", "assumed", least=0.0
    ),
    Parameter("tyre_stiffness", 5e5, "N/m", "tyre against floor, each way", "assumed, 5 mm of polyurethane"),
    Parameter("tyre_damping", 4000.0, "N.s/m", "tyre against floor, at rest", "assumed"),
    Parameter(
        "rolling_resistance",
        0.003,
        "1",
        "rolling resistance over the load; none in [R]",
        "assumed, lever arm 0.15 mm on 50 mm: tables have 0.08 mm for polymer on steel, 0.2 mm on concrete",
        least=0.0,
        tunable=True,
    ),
    Parameter(
        "rolling_presliding", 0.002, "rad", "wheel angle over which it builds up, front", "assumed", least=0.0
    ),
    Parameter("front_radius", 0.050, "m", "front wheel's radius", "[R] 2.3", least=0.0),
    Parameter("front_spin_inertia", 463e-6, "kg.m2", "front wheel about its axle I_wxx", "[R] Tab. 3.2"),
)

STEERING: Final[tuple[Parameter, ...]] = (
    Parameter(
        "kingpin_distance",
        0.210,
        "m",
        "front kingpin to kingpin a_k",
        "[R] 2.4.1; App. C has 0.190",
        least=0.0,
    ),
    Parameter(
        "davis_h", 0.030, "m", "Davis linkage h", "[R] App. C, optimum; (2.15) implies 0.060", least=0.0
    ),
    Parameter(
        "pinion_diameter", 0.030, "m", "pitch circle of the pinion D_p", "[R] 4.2; 2.4.2 has 0.040", least=0.0
    ),
    Parameter("tie_rod_mass", 0.200, "kg", "tie rod m_10", "[R] Tab. 3.2"),
    Parameter("link_mass", 0.080, "kg", "steering link m_l", "[R] Tab. 3.2"),
    Parameter("link_centre", 0.018, "m", "kingpin to the link's centre r_o", "[R] Tab. 3.2", least=0.0),
    Parameter("link_inertia", 60834e-9, "kg.m2", "steering link I_zz", "[R] Tab. 3.2 read as g mm2"),
    Parameter("front_wheel_mass", 0.350, "kg", "front wheel m_w", "[R] Tab. 3.2"),
    Parameter(
        "kingpin_offset",
        0.05,
        "m",
        "kingpin to wheel centre l_3",
        "assumed, stands in Fig. 3.22 only",
        least=0.0,
    ),
    Parameter(
        "tyre_torque",
        0.4,
        "N.m",
        "resistance to steering of one wheel T_s",
        "[R] (2.14)",
        least=0.0,
        tunable=True,
    ),
    Parameter("rack_travel", 0.042, "m", "rack's end stop either side", "assumed, 61.6 degrees", least=0.0),
    Parameter("rack_stop_stiffness", 1e7, "N/m", "rack's end stop", "assumed"),
    Parameter("rack_stop_damping", 10.0, "s/m", "rack's end stop, part of its force per speed", "assumed"),
)

LIFT: Final[tuple[Parameter, ...]] = (
    Parameter("lift_stages", 6.0, "1", "scissor stages N", "[R] 2.5", least=0.0),
    Parameter(
        "lift_link_length", 0.300, "m", "scissor link l_s", "assumed, fits the heights of [R] 2.5", least=0.0
    ),
    Parameter(
        "lift_collapsed_angle",
        math.radians(5.0),
        "rad",
        "link angle collapsed",
        "[R] 2.5",
        least=0.0,
        most=1.5,
    ),
    Parameter(
        "lift_extended_angle",
        math.radians(45.0),
        "rad",
        "link angle extended",
        "[R] 2.5",
        least=0.0,
        most=1.5,
    ),
    Parameter("screw_pitch", 0.0015, "m", "screw pitch p", "[R] 2.5", least=0.0),
    Parameter("screw_diameter", 0.010, "m", "mean diameter d_m", "[R] 2.5; 15 mm beside (2.18)", least=0.0),
    Parameter(
        "screw_friction",
        0.10,
        "1",
        "thread friction mu",
        "[R] beside (2.18); locks itself above 0.041",
        least=0.0,
    ),
    Parameter(
        "thread_angle",
        math.radians(30.0),
        "rad",
        "half flank angle alpha",
        "[R] beside (2.18): 2 alpha = 60 degrees",
        least=0.0,
        most=1.5,
    ),
    Parameter("lift_mass", 1.0, "kg", "lifted platform", "assumed, what the 10 W motor lifts from 5 degrees"),
    Parameter(
        "lift_payload", 0.0, "kg", "load on the lifted platform", "assumed; [R] 2.5 has 8", tunable=True
    ),
    Parameter(
        "lift_clearance", 5e-5, "m", "nut travel from either end position to its stop", "assumed", least=0.0
    ),
    Parameter("lift_stop_stiffness", 1e8, "N/m", "lift's end stops, at the nut", "assumed"),
    Parameter(
        "lift_stop_damping", 100.0, "s/m", "lift's end stops, part of their force per speed", "assumed"
    ),
)

PARAMETERS: Final[tuple[Parameter, ...]] = MOTORS + PLATFORM + TYRES + STEERING + LIFT

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "A": {},
    "B": {
        "rear_track": 0.210,
        "wheel_mass": 0.5,
        "yaw_inertia": 3.2,
        "wheel_yaw_inertia": 2.5e-4,
        "wheel_spin_inertia": 4.6395e-4,
    },
    "A_plausible_yaw": {"yaw_inertia": 3.2},
}
"""Named start values where [R] contradicts itself: A is Tab. 3.1 (the defaults), B the set that the numbers
printed in (3.78) follow from, A_plausible_yaw is A with the yaw inertia of B."""

ROBOT_FILE: Final[Mapping[str, tuple[str, float]]] = {
    "geometry.base.wheel_radius_m": ("wheel_radius", 1.0),
    "geometry.base.rear_track_m": ("rear_track", 1.0),
    "geometry.base.wheelbase_m": ("wheelbase", 1.0),
    "geometry.base.kingpin_distance_m": ("kingpin_distance", 1.0),
    "geometry.base.davis_h_m": ("davis_h", 1.0),
    "geometry.base.pinion_diameter_m": ("pinion_diameter", 1.0),
    "geometry.base.centre_of_gravity_height_m": ("cg_height", 1.0),
    "geometry.base.centre_offset_m": ("centre_offset", 1.0),
    "axes.left.ratio": ("gear_left", 1.0),
    "axes.right.ratio": ("gear_right", 1.0),
    "axes.steer.ratio": ("gear_steer", 1.0),
    "axes.lift.ratio": ("gear_lift", 1.0),
    "geometry.lift.stages": ("lift_stages", 1.0),
    "geometry.lift.link_length_m": ("lift_link_length", 1.0),
    "geometry.lift.collapsed_angle_deg": ("lift_collapsed_angle", math.pi / 180.0),
    "geometry.lift.extended_angle_deg": ("lift_extended_angle", math.pi / 180.0),
    "geometry.lift.screw_pitch_m": ("screw_pitch", 1.0),
    "battery.nominal_v": ("battery_emf", 1.0),
}
"""Path into a robot file (axes by name) -> FMU parameter and the factor into its unit."""

PLANT: Final = Plant("rars", "fmu.rars", PARAMETERS, SETS, ROBOT_FILE)
