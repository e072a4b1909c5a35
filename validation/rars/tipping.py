"""Limits of RARS's acceleration and turn rate before it tips, [R] 2.3.1.

Ours are the plant's own wheel loads, and the interlock of the turn; the independent way is a sum of moments.
"""

import math
from typing import Any, Final

import numpy as np

from emulators.robots.rars import steer_of_radius
from firmware_bridge.motion.scissor import screw_from_height
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars.rules import tipping_speed
from firmware_bridge.units import STANDARD_GRAVITY
from fmu.build import ensure
from fmu.plant import FmuPlant
from fmu.rars_tipping.interface import INPUTS, OUTPUTS
from fmu.rars_tipping.parameters import SETS
from validation.rars.plant import PLAIN, STEP, P, Plant
from validation.studies.solve import root
from validation.studies.study import Compared, Curve, Findings, Plot

G: Final = P["gravity"]
TOTAL: Final = P["platform_mass"] + 2.0 * P["wheel_mass"]
SETTLES: Final = 500
"""Steps until tyres and windings have settled."""
GRIPS: Final = 3.0
"""A floor on which it tips before it slides; on the thesis's, 0.3, it slides first."""
OF_THE_PRINT: Final = 0.141
"""m: the center of mass before the rear axle that the printed 0.144 g follows from; Tab. 3.1 has 0.220."""


NO_FIGURES: Final = (
    "The source's figures are not at hand, only its text and equations: the curves are of its equations."
)


RECTANGLE: Final = (
    "The static angles are of the plant rars_tipping, on the source's rectangle; on the wheels' own "
    "trapezium it tips sideways at 25.3°."
)


def tipping(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    slopes = np.radians(np.linspace(0.0, 30.0, 3 if quick else 7))
    robot = find("rars")
    radii = np.linspace(0.415, 2.0, 30)
    limits = np.array([tipping_speed(robot, steer_of_radius(radius, robot)) for radius in radii])
    ours = {offset: [_lifts_at(offset, slope) for slope in slopes] for offset in (0.141, 0.220)}
    fine = np.radians(np.linspace(0.0, 30.0, 61))
    heights = np.linspace(0.5, 1.5, 40)
    return Findings(
        compared=(
            Compared(
                "acceleration that lifts the front wheels, 30° uphill, center of mass at 141 mm",
                "g",
                0.144,
                _moments(OF_THE_PRINT, math.radians(30.0)) / G,
                ours[OF_THE_PRINT][-1] / G,
                0.002,
                "141 mm is what the print was worked back to, rounded: 141.3 mm give 0.144 g",
            ),
            Compared(
                "the same with the center of mass of Tab. 3.1, 220 mm",
                "g",
                None,
                _moments(0.220, math.radians(30.0)) / G,
                ours[0.220][-1] / G,
                0.002,
                "(2.3), (2.4) measure b from the rear axle, Tab. 3.1 from the front one; 0.144 g: 141 mm",
            ),
            Compared(
                "speed that tips it in the tightest turn, R = 415 mm",
                "m/s",
                1.9,
                _balanced(0.415),
                float(limits[0]),
                1e-6,
                "rounded in print; (2.5) lacks Z_cg, (2.6) and (2.7) have it",
            ),
            *(
                Compared(
                    f"static angle at which it tips {way}, table at 1.5 m, 10 kg on it",
                    "°",
                    printed,
                    math.degrees(math.atan(arm / _height(1.5, 10.0))),
                    _tips_at(uphill),
                    0.1,
                    "the print lifts 8 kg of scissor by h / 2 from the floor on: 0.410 m; from the retracted "
                    "table on, which leaves its 0.190 m there, it is 0.404 m",
                )
                for way, arm, uphill, printed in (
                    ("backwards", 0.141, 0.0, 19.0),
                    ("sideways", 0.168, math.pi / 2.0, 22.3),
                )
            ),
        ),
        plots=(
            Plot(
                "Acceleration that lifts the front wheels",
                "slope, uphill [°]",
                "acceleration [g]",
                (
                    *(
                        Curve(
                            f"sum of moments, center of mass at {1000 * offset:.0f} mm",
                            np.degrees(fine),
                            [_moments(offset, slope) / G for slope in fine],
                        )
                        for offset in ours
                    ),
                    *(
                        Curve(
                            f"plant, {1000 * offset:.0f} mm",
                            np.degrees(slopes),
                            np.array(found) / G,
                            "points",
                        )
                        for offset, found in ours.items()
                    ),
                    Curve("limit of the robot, 0.144 g (2.3.1)", [0.0, 30.0], [0.144, 0.144], "dashed"),
                ),
                "Where the front pair's load reaches 0, (2.4): a = g (x cos / z - sin), on a floor that "
                "grips. The limit of the robot is the worst case, 30° with 141 mm.",
            ),
            Plot(
                "Speed that tips it in a turn",
                "radius of the rear axle's middle [m]",
                "speed [m/s]",
                (
                    Curve("interlock, sqrt(R g d / Z_cg) (2.7)", radii, limits),
                    Curve(
                        "moments, by bisection",
                        radii[::5],
                        [_balanced(radius) for radius in radii[::5]],
                        "points",
                    ),
                    Curve("limit of the robot, 0.5 m/s", [radii[0], radii[-1]], [0.5, 0.5], "dashed"),
                    Curve(
                        "where its tyres slide at mu = 0.3",
                        radii,
                        np.sqrt(P["floor_friction"] * G * radii),
                        "dots",
                    ),
                ),
                "(2.5) to (2.7) with d = 168 mm, Z_cg = 190 mm. The robot's limit of speed binds first at "
                "every radius that it can turn, and on the thesis's floor it slides before it tips.",
            ),
            Plot(
                "What the lift does to it",
                "height h of the lift's top [m]",
                "static angle at which it tips [°]",
                tuple(
                    Curve(
                        f"{way}, payload {load:.0f} kg",
                        heights,
                        np.degrees(np.arctan(arm / _height(heights, load))),
                    )
                    for load in (0.0, 10.0)
                    for way, arm in (("backwards", 0.141), ("sideways", 0.168))
                ),
                "Center of gravity with lift height h and payload m_p at its top (assumed): 190 mm at "
                "h = 0.5 m, 8 kg of scissor rise by (h - 0.5 m) / 2; arms 141 mm and 168 mm; Tab. 2.1 has "
                "0.5 to 1.5 m.",
            ),
        ),
        remarks=(
            NO_FIGURES,
            "The usual plant shifts load along, not across: the turn has no run of it.",
            RECTANGLE,
        ),
    )


def _moments(offset: float, slope: float) -> float:
    """Return the acceleration in m/s2 at which the moments about the rear contact leave none for the front.

    By bisection on the front pair's load; `offset` is the whole robot's, wheels included.
    """

    def front(acceleration: float) -> float:
        holds = TOTAL * G * math.cos(slope) * offset
        tips = TOTAL * (acceleration + G * math.sin(slope)) * P["cg_height"]
        return (holds - tips) / P["wheelbase"]

    return root(front, -20.0, 20.0)


def _balanced(radius: float) -> float:
    """Return the speed in m/s at which the inner wheels bear nothing, by bisection."""
    base = find("rars").geometry.base

    def inner(speed: float) -> float:
        outward = speed * speed / radius * base.centre_of_gravity_height_m
        return float(STANDARD_GRAVITY * base.half_support_width_m - outward)

    return root(inner, 0.0, 50.0)


def _lifts_at(offset: float, slope: float) -> float:
    """Return the acceleration in m/s2 at which the plant's front load is 0, on a line through two runs."""
    (low, least), (high, most) = (_pushed(offset, slope, extra) for extra in (-10.0, 10.0))
    return least - low * (most - least) / (high - low)


def _pushed(offset: float, slope: float, push: float) -> tuple[float, float]:
    """Return the front pair's load in N and the acceleration; pushed uphill by its weight and `push` N."""
    parameters = {
        "floor_friction": GRIPS,
        "centre_offset": offset * TOTAL / P["platform_mass"],
        "slope": slope,
        **PLAIN,
    }
    weight = TOTAL * G * math.sin(slope)
    torque = (weight + push) * P["wheel_radius"] / 2.0
    loads, speeds = [], []
    with Plant(**parameters) as plant:
        for step in range(3 * SETTLES):
            plant.turn(torque, torque)
            if step >= SETTLES:
                loads.append(plant["load_front_left"] + plant["load_front_right"])
                speeds.append(plant["speed"])
    return float(np.mean(loads)), (speeds[-1] - speeds[0]) / (1e-4 * (len(speeds) - 1))


def _tips_at(uphill: float) -> float:
    """Return the slope in degrees at which the plant that tips over has no margin left, at standstill.

    `uphill`: its direction from the robot's nose, rad.
    """
    screw = screw_from_height(find("rars").geometry.lift, 1.0)
    start = {
        **SETS["2.3.1_rectangle"],
        "angle_lift": screw * P["gear_lift"],
        "lift_payload": 10.0,
        "slope_heading": uphill,
        "floor_friction": 1.0,
        "coulomb_left": 50.0,
        "coulomb_right": 50.0,
    }

    def margin(degrees: float) -> float:
        values = {**start, "slope": math.radians(degrees)}
        with FmuPlant(ensure("rars_tipping"), tuple(INPUTS), tuple(OUTPUTS), values, STEP) as plant:
            plant.step()
            return plant.read("zmp_margin")

    return root(margin, 5.0, 30.0)


def _height(heights: Any, payload: float) -> Any:
    return (70.0 * 0.190 + 8.0 * (heights - 0.5) / 2.0 + payload * heights) / (70.0 + payload)
