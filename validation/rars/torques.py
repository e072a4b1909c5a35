"""The torques that drive RARS round a circle of 5 m, flat and on a ramp, [R] 3.3 and 3.4.5.

Ours are the platform's equations in the plant, solved for what the rear wheels must push. The independent way
knows no equation of motion: it moves the masses along the path, takes second differences, and adds up.
"""

import math
from functools import cache
from typing import Final

import numpy as np
import sympy as sp

from fmu.parts.planar import PlanarBody, Push
from fmu.parts.symbols import symbol
from validation.rars.plant import P
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot

RADIUS: Final = 5.0
LASTS: Final = 60.0
"""s, T of (3.41)."""
RAMP: Final = math.radians(10.0)
SPIRAL: Final = "spiral ramp of 10°"
"""As steep at every place: uphill is where it drives. The thesis prints neither its radius nor its rise:
those of the circle and of the ramp, assumed."""
SLOPES: Final = {"flat": 0.0, "ramp of 10°": RAMP, SPIRAL: RAMP}
RIM: Final = P["wheel_radius"]
TRACK: Final = P["rear_track"]
AHEAD: Final = P["centre_offset"]
STEP: Final = 1e-3
"""s, of the differences."""
SIDES: Final = {"left": 1.0, "right": -1.0}
PRINTED: Final = ("ramp of 10°",)
"""Floors for which the printed (3.44) is wrong."""
PRINT: Final = (
    "(3.44) as printed lacks the mass, so its ramp is flat; 3.3.2 leaves out the platform's convective term."
)


def torques(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    times = np.linspace(0.0, LASTS, 25 if quick else 121)
    ours = {name: np.array([_solved(at, name) for at in times]) for name in SLOPES}
    added = {name: np.array([_added(at, name) for at in times]) for name in SLOPES}
    printed = np.array([_printed(at, RAMP) for at in times])
    return Findings(
        compared=(
            *(
                Compared(
                    f"largest torque, {side} wheel, {name}",
                    "N.m",
                    float(np.abs(printed[:, place]).max()) if name in PRINTED else None,
                    float(np.abs(added[name][:, place]).max()),
                    float(np.abs(ours[name][:, place]).max()),
                    1e-4,
                    "what follows from (3.44) as printed: its gravity term lacks the mass"
                    if name in PRINTED
                    else "",
                )
                for name in SLOPES
                for place, side in enumerate(SIDES)
            ),
            *(
                Compared(
                    f"largest distance between both ways on the way round, {name}",
                    "N.m",
                    None,
                    0.0,
                    float(np.abs(ours[name] - added[name]).max()),
                    1e-4,
                )
                for name in SLOPES
            ),
        ),
        plots=(
            *(
                Plot(
                    f"Torques of the rear wheels, {name}",
                    "time [s]",
                    "torque [N.m]",
                    (
                        *(
                            Curve(f"plant's equations, {side}", times, ours[name][:, place])
                            for place, side in enumerate(SIDES)
                        ),
                        *(
                            Curve(
                                f"second differences, {side}", times[::4], added[name][::4, place], "points"
                            )
                            for place, side in enumerate(SIDES)
                        ),
                        *(
                            [Curve("(3.44) as printed, left", times, printed[:, 0], "dots")]
                            if name in PRINTED
                            else []
                        ),
                    ),
                    f"Circle of 5 m to the left by beta(t) (3.41), {name}; two wheels, no slip; Tab. 3.1.",
                )
                for name in SLOPES
            ),
            Plot(
                "The path's speed",
                "time [s]",
                "speed of the center of mass [m/s]",
                (
                    Curve("R d(beta)/dt", times, [RADIUS * turned_by(at)[1] for at in times]),
                    Curve("limit of the robot, 0.5 m/s", [0.0, LASTS], [0.5, 0.5], "dashed"),
                ),
                "beta(t) = 20 pi s³ - 30 pi s⁴ + 12 pi s⁵, s = t / T (3.41).",
            ),
        ),
        remarks=(PRINT,),
    )


def turned_by(at: float) -> tuple[float, float, float]:
    """Return beta and its rates (3.41)."""
    s = at / LASTS
    return (
        math.pi * (20.0 * s**3 - 30.0 * s**4 + 12.0 * s**5),
        60.0 * math.pi / LASTS * (s * (1.0 - s)) ** 2,
        60.0 * math.pi / LASTS**2 * 2.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    )


def _place(at: float) -> tuple[float, float, float]:
    """Return the rear axle's middle, sqrt(R2 - a2) from the center, and the heading; O3 is on the circle."""
    beta = turned_by(at)[0]
    inner = math.sqrt(RADIUS**2 - AHEAD**2)
    return inner * math.cos(beta), inner * math.sin(beta), beta + math.pi / 2.0


def _motion(at: float) -> tuple[float, float, float, float, float]:
    """Return heading, speed of the axle's middle, yaw rate, and the rates of both."""
    beta, rate, change = turned_by(at)
    inner = math.sqrt(RADIUS**2 - AHEAD**2)
    return beta + math.pi / 2.0, inner * rate, rate, inner * change, change


@cache
def _equations() -> "sp.Lambda":
    """Return the plant's u', q', W' for pushes of the left and the right wheel and along the axle."""
    left, right, side, slope = sp.symbols("push_left push_right push_side slope")
    total, offset = P["platform_mass"] + 2.0 * P["wheel_mass"], P["platform_mass"] * AHEAD
    about = P["yaw_inertia"] + 2.0 * P["wheel_yaw_inertia"] + offset * AHEAD
    about += 2.0 * P["wheel_mass"] * (TRACK / 2.0) ** 2
    body = PlanarBody(mass=total, offset_mass=offset, inertia=about, downhill=P["gravity"] * sp.sin(slope))
    rates = body.accelerations((Push(left + right, side, TRACK / 2.0 * (right - left)),))
    names = [symbol(name) for name in ("heading", "speed", "drift", "yaw_rate")]
    return sp.lambdify([*names, left, right, side, slope], rates)


def _downhill(at: float, floor: str) -> float:
    """Return where it goes down: a ramp falls along x, away from where the circle begins; a spiral behind."""
    return _motion(at)[0] + math.pi if floor == SPIRAL else math.pi


def _solved(at: float, floor: str) -> tuple[float, float]:
    """Return the torques, left and right, that give the path's accelerations in the plant's equations."""
    heading, speed, turn, change, turning = _motion(at)
    function, slope = _equations(), SLOPES[floor]
    # The plant's floor falls one way; of its heading nothing but the way downhill enters the accelerations.
    from_uphill = heading - _downhill(at, floor) + math.pi

    def rates(*pushes: float) -> Floats:
        return np.array(function(from_uphill, speed, 0.0, turn, *pushes, slope), dtype=float)

    none = rates(0.0, 0.0, 0.0)
    columns = [rates(*row) - none for row in np.eye(3)]
    pushes = np.linalg.solve(np.array(columns).T, np.array([change, 0.0, turning]) - none)
    return _with_spin(pushes[0], pushes[1], change, turning)


def _with_spin(left: float, right: float, change: float, turning: float) -> tuple[float, float]:
    """Return the wheels' torques: r F, and what their own spin takes, I_w w' (3.73) corrected."""
    spin = P["wheel_spin_inertia"] / RIM
    return (
        RIM * left + spin * (change - TRACK / 2.0 * turning),
        RIM * right + spin * (change + TRACK / 2.0 * turning),
    )


def _added(at: float, floor: str) -> tuple[float, float]:
    """Return the torques from where the masses are a little before and after, and what turns with them."""
    before, now, after = (_place(at + part * STEP) for part in (-1.0, 0.0, 1.0))
    x, y, heading = now
    ahead = (math.cos(heading), math.sin(heading))
    turning = (before[2] - 2.0 * heading + after[2]) / STEP**2
    force, moment = np.zeros(2), (P["yaw_inertia"] + 2.0 * P["wheel_yaw_inertia"]) * turning
    falls = _downhill(at, floor)
    downhill = P["gravity"] * math.sin(SLOPES[floor]) * np.array([math.cos(falls), math.sin(falls)])
    masses = [(P["platform_mass"], AHEAD, 0.0)]
    masses += [(P["wheel_mass"], 0.0, side * TRACK / 2.0) for side in SIDES.values()]
    for mass, along, across in masses:
        way = [_point(pose, along, across) for pose in (before, now, after)]
        push = mass * ((way[0] - 2.0 * way[1] + way[2]) / STEP**2 - downhill)
        arm = way[1] - (x, y)
        force += push
        moment += float(arm[0] * push[1] - arm[1] * push[0])
    half = float(force @ ahead) / 2.0
    change = (_point(before, 0.0, 0.0) - 2.0 * np.array([x, y]) + _point(after, 0.0, 0.0)) @ ahead / STEP**2
    return _with_spin(half - moment / TRACK, half + moment / TRACK, float(change), turning)


def _point(pose: tuple[float, float, float], along: float, across: float) -> Floats:
    x, y, heading = pose
    return np.array(
        [
            x + along * math.cos(heading) - across * math.sin(heading),
            y + along * math.sin(heading) + across * math.cos(heading),
        ]
    )


def _printed(at: float, slope: float) -> tuple[float, float]:
    """Return (3.44) as it is printed: no mass in the gravity term, no convective term."""
    heading, _, _, change, turning = _motion(at)
    total = P["platform_mass"] + 2.0 * P["wheel_mass"]
    about = P["yaw_inertia"] + 2.0 * P["wheel_yaw_inertia"] + P["platform_mass"] * AHEAD**2
    about += 2.0 * P["wheel_mass"] * (TRACK / 2.0) ** 2
    push = total * change + P["gravity"] * math.sin(slope) * math.cos(heading)
    return _with_spin(
        push / 2.0 - about * turning / TRACK, push / 2.0 + about * turning / TRACK, change, turning
    )
