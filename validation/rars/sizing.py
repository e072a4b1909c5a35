"""Required torque of RARS's motors: traction, steering, screw, [R] 2.3.2, 2.4.2 and 2.5.

Ours is the plant: the current that each motor takes in slow motion, without its own friction. The independent
way is statics, by virtual work or by the inclined plane of a thread.
"""

import math
from typing import Final

import numpy as np

from firmware_bridge.motion import davis
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND
from validation.rars.plant import PLAIN, STEP, P, Plant
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot

G: Final = P["gravity"]
TOTAL: Final = 80.0
"""kg, robot and payload, 2.3.2."""
LOADS: Final = (5.0, 8.0)
"""kg on the lift: what the printed 342 kgf and 7.5 N.m belong to, and 2.5's own."""
THREAD: Final = 0.015
"""m, mean diameter beside (2.18)."""
STRONG: Final = 0.1
"""Ohm: a lift motor that can."""
SPEED: Final = 50.0
"""rad/s of the lift motor: 0.5 mm/s of the nut, so inertia takes 0.1 % at most."""
SCREW: Final = (
    "The screw is driven so slowly that inertia does not count, by a motor that is strong enough; its own "
    "is not, see fmu/rars/README.md."
)
STEER: Final = (
    "(2.15) as printed has a factor 2 more: it must be 2 T_s / h, times half the pinion. The printed "
    "number has Davis h = 60 mm in it and a factor of safety; here h = 30 mm, D_p = 30 mm, and none."
)


def sizing(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    base = find("rars").geometry.base
    heights = np.linspace(0.0, 0.35, 60)
    lifted = {load: _lifted(load, 0.05 if quick else 0.3) for load in LOADS}
    turned = _turned()
    climbing = _climbing(math.radians(30.0))
    angles = np.linspace(5.0, 60.0, 56)
    return Findings(
        compared=(
            Compared(
                "torque of each rear wheel, 30°, 80 kg, at rest",
                "N.m",
                5.0,
                TOTAL * G * math.sin(math.radians(30.0)) * P["wheel_radius"] / 2.0,
                climbing,
                0.02,
                "the print has the 20 kgf that mu = 0.3 carries, 4.9 N.m: half of what the slope takes",
            ),
            Compared(
                "pinion's torque against both front wheels, rack in the middle",
                "N.m",
                None,
                2.0 * P["tyre_torque"] / P["davis_h"] * P["pinion_diameter"] / 2.0 * _middle(),
                turned,
                0.004,
                "(2.15) prints twice this form",
            ),
            *(
                Compared(
                    f"screw's torque just above 5°, {load:g} kg on the lift, d_m = 15 mm",
                    "N.m",
                    printed,
                    thread(load, lifted[load][0][0]),
                    lifted[load][1][0],
                    0.03,
                    why,
                )
                for load, printed, why in (
                    (5.0, 7.5, "(2.18) without its 1/2"),
                    (8.0, None, "2.5 has 8 kg, its numbers have 5 kg"),
                )
            ),
            Compared(
                "force along the nut at 5°, 5 kg on the lift (2.17)",
                "kgf",
                342.0,
                LOADS[0] * _rise(0.0),
                lifted[5.0][1][0] / thread(1.0, lifted[5.0][0][0]) * _rise(0.0),
                2.0,
                "the plant's torque, back through (2.18)",
            ),
            Compared(
                "turn at 60° of the inner wheel",
                "mm",
                402.0,
                1e3 * _crossing(math.radians(60.0)),
                1e3 * davis.turn_radius(base, math.radians(60.0)),
                0.01,
                "printed rounded down; 415 mm (Tab. 2.1, App. C) is the built robot, at 58.95°",
            ),
        ),
        plots=(
            Plot(
                "Screw's torque over the height",
                "height of the lift over collapsed [m]",
                "torque [N.m]",
                (
                    *(
                        Curve(f"inclined plane, {load:g} kg", heights, [thread(load, at) for at in heights])
                        for load in LOADS
                    ),
                    *(
                        Curve(f"plant, {load:g} kg", lifted[load][0], lifted[load][1], "points")
                        for load in LOADS
                    ),
                ),
                "(2.17), (2.18): mu = 0.1, thread 60°, d_m = 15 mm, p 1.5 mm, N = 6, links 0.3 m (assumed).",
            ),
            Plot(
                "Radius of the turn",
                "inner wheel's angle [°]",
                "radius of the rear axle's middle [m]",
                (
                    Curve(
                        "motion/davis, (2.13)",
                        angles,
                        [davis.turn_radius(base, math.radians(angle)) for angle in angles],
                    ),
                    Curve(
                        "where the wheels' axles cross",
                        angles[::5],
                        [_crossing(math.radians(angle)) for angle in angles[::5]],
                        "points",
                    ),
                    Curve("least radius, 415 mm", [5.0, 60.0], [0.415, 0.415], "dashed"),
                ),
                "R = a_k / 2 + w cot(theta), w = 515 mm, a_k = 210 mm (2.4.1).",
            ),
        ),
        remarks=(SCREW, STEER),
    )


def thread(load: float, height: float) -> float:
    """Return the screw's torque in N.m that lifts: the load climbs the thread as a block an inclined plane.

    The flank's angle widens the friction: mu / cos(30°); (2.18) with its 1/2.
    """
    lead = math.atan(P["screw_pitch"] / (math.pi * THREAD))
    rubs = math.atan(P["screw_friction"] / math.cos(P["thread_angle"]))
    return load * G * _rise(height) * THREAD / 2.0 * math.tan(lead + rubs)


def _rise(height: float) -> float:
    """Return how far the platform rises for a meter of the nut, by a difference: (2.17) by virtual work."""
    stages, link = P["lift_stages"], P["lift_link_length"]
    sine = height / (stages * link) + math.sin(P["lift_collapsed_angle"])
    along, little = math.sqrt(1.0 - sine * sine) * link, 1e-7

    def raised(length: float) -> float:
        return stages * math.sqrt(link * link - length * length)

    return (raised(along - little) - raised(along + little)) / (2.0 * little)


def _middle() -> float:
    """Return T_s f(0) over T_s / h: b turns the levers a little, (3.96)."""
    b = P["davis_h"] * P["kingpin_distance"] / (2.0 * P["wheelbase"])
    return P["davis_h"] ** 2 / (P["davis_h"] ** 2 + b**2)


def _crossing(inner: float) -> float:
    """Return how far from its middle the rear axle's line is met by the inner front wheel's axle."""
    kingpin = np.array([P["wheelbase"], P["kingpin_distance"] / 2.0])
    across = np.array([-math.sin(inner), math.cos(inner)])
    return float(kingpin[1] + across[1] * (kingpin[0] / -across[0]))


def _climbing(slope: float) -> float:
    """Return the torque of each wheel that holds the plant's speed on a slope on which nothing slips."""
    wheels = 2.0 * P["wheel_mass"]
    parameters = {"slope": slope, "floor_friction": 3.0, "platform_mass": TOTAL - wheels, **PLAIN}
    torque = 0.0
    with Plant(**parameters) as plant:
        for _ in range(round(1.5 * SECOND / STEP)):
            torque += STEP / SECOND * 300.0 * -plant["speed"]
            plant.turn(*(torque - 30.0 * plant["speed"],) * 2)
        return P["torque_constant_left"] * P["gear_left"] * plant["current_left"]


def _turned() -> float:
    """Return the torque at the pinion that turns the front wheels slowly, rack in the middle."""
    with Plant(coulomb_steer=0.0, viscous_steer=0.0) as plant:
        plant.steer(P["torque_constant_steer"] * 20.0 + P["resistance_steer"] * 0.1)
        while plant["angle_steer"] < 1.0:
            plant.rests(1e-3)
        return P["torque_constant_steer"] * plant["current_steer"] * P["gear_steer"]


def _lifted(load: float, most: float) -> tuple[Floats, Floats]:
    """Return heights in m and the screw's torque there in N.m, from the plant's lift motor."""
    constant = P["torque_constant_lift"]
    parameters = {
        "lift_mass": load,
        "screw_diameter": THREAD,
        "coulomb_lift": 0.0,
        "viscous_lift": 0.0,
        "resistance_lift": STRONG,
    }
    rows: list[tuple[float, float]] = []
    with Plant(**parameters) as plant:
        plant.lift(constant * SPEED + STRONG * thread(load, 0.0) / (constant * P["gear_lift"]))
        plant.rests(0.1)
        while plant["lift_height"] < most:
            rows.append((plant["lift_height"], constant * P["gear_lift"] * plant["current_lift"]))
            plant.rests(0.2)
    found = np.array(rows)
    return found[:, 0], found[:, 1]
