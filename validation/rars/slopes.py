"""Steepest slope that RARS climbs, and its wheels' slip on it, [R] 2.3.2, 3.3.4 and 3.4.

Ours is the plant, driven uphill by its rear wheels; the independent way is the balance of force and moment
with the corrected (3.83).
"""

import math
from typing import Final

import numpy as np

from firmware_bridge.units import SECOND
from validation.rars.plant import PLAIN, STEP, P, Plant
from validation.studies.solve import root
from validation.studies.study import Compared, Curve, Findings, Plot

TOTAL: Final = P["platform_mass"] + 2.0 * P["wheel_mass"]
SPEED: Final = 0.3
"""m/s of the rims; slip does not depend on it."""
STIFF: Final = 2000.0
"""N for each m/s that a rim is too slow: holds its speed."""
SECONDS: Final = 1.2
OFFSETS: Final = {141: 0.141, 220: 0.220}
"""mm, m: the whole robot's center of mass before the rear axle, as (2.4)'s limit implies, and as Tab. 3.1."""
HONEST: Final = (
    "Tab. 2.1 has a ramp of 30°. With the friction of 3.4.5 the robot slides on it: it takes mu 0.6 and more."
)
COMBINED: Final = (
    "Straight uphill nothing slips sideways, so the friction circle, an option of ours, plays no part."
)


def slopes(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    degrees = (2.0, 6.0, 9.0) if quick else (1.0, 2.0, 4.0, 6.0, 8.0, 9.0, 10.0)
    driven = [_climbed(math.radians(slope), 0.220, P["floor_friction"])[0] for slope in degrees]
    balanced = [slip(math.radians(slope), 0.220, P["floor_friction"]) for slope in degrees]
    steps = 7 if quick else 9
    fine = np.linspace(0.0, 10.8, 60)
    frictions = np.linspace(0.1, 1.0, 40)
    return Findings(
        compared=(
            *(
                Compared(
                    f"steepest slope that it climbs, mu = 0.3, center of mass at {name} mm",
                    "°",
                    None,
                    math.degrees(steepest(offset, 0.3)),
                    math.degrees(_found(offset, 0.3, steps)),
                    0.15,
                    "printed is only the ramp of 30° of Tab. 2.1, which this friction does not carry",
                )
                for name, offset in OFFSETS.items()
            ),
            Compared(
                "friction that 30° take, center of mass at 141 mm",
                "1",
                0.3,
                root(lambda mu: steepest(0.141, mu) - math.radians(30.0), 0.05, 2.0),
                _friction_for(math.radians(30.0), 0.141, steps),
                0.01,
                "2.3.2 takes mu = 0.3 and 20 kgf of traction; m g sin(30°) is 40 kgf",
            ),
            *(
                Compared(f"slip of the rear wheels on {slope:g}°", "1", None, wanted, found, 0.001)
                for slope, wanted, found in zip(degrees, balanced, driven, strict=True)
            ),
        ),
        plots=(
            Plot(
                "Slip uphill, mu = 0.3",
                "slope [°]",
                "slip of the rear wheels [1]",
                (
                    Curve(
                        "balance and (3.83)", fine, [slip(math.radians(slope), 0.220, 0.3) for slope in fine]
                    ),
                    Curve("plant, at 0.3 m/s of the rims", degrees, driven, "points"),
                    Curve("peak of adhesion, 0.15", [0.0, 10.8], [0.15, 0.15], "dashed"),
                ),
                "Center of mass at 220 mm (Tab. 3.1). At the peak of (3.83), corrected, the wheels run away.",
            ),
            Plot(
                "Steepest slope",
                "friction of the floor, mu [1]",
                "slope [°]",
                (
                    *(
                        Curve(
                            f"balance, center of mass at {name} mm",
                            frictions,
                            [math.degrees(steepest(offset, mu)) for mu in frictions],
                        )
                        for name, offset in OFFSETS.items()
                    ),
                    Curve("ramp of Tab. 2.1", [0.1, 1.0], [30.0, 30.0], "dashed"),
                    Curve("ramp of 3.3.4", [0.1, 1.0], [10.0, 10.0], "dots"),
                ),
                "Rear drive, load transfer included: tan = mu (1 - x / w) / (1 - mu z / w).",
            ),
        ),
        remarks=(HONEST, COMBINED),
    )


def steepest(offset: float, friction: float) -> float:
    """Return the slope in rad that the rear wheels' friction carries."""
    wheelbase = P["wheelbase"]
    share = 1.0 - friction * P["cg_height"] / wheelbase
    return math.atan2(friction * (1.0 - offset / wheelbase), share)


def slip(slope: float, offset: float, friction: float) -> float:
    """Return the slip that carries the robot's weight on the slope, on the rising branch of (3.83)."""
    wheelbase = P["wheelbase"]
    rear = math.cos(slope) * (1.0 - offset / wheelbase) + math.sin(slope) * P["cg_height"] / wheelbase
    return P["peak_slip"] * math.sin(slope) / (friction * rear)


def _found(offset: float, friction: float, steps: int) -> float:
    """Return the steepest slope that the plant climbs, by halving; rad."""
    low, high = math.radians(4.0), math.radians(20.0)
    for _ in range(steps):
        middle = (low + high) / 2.0
        if _climbed(middle, offset, friction)[1]:
            low = middle
        else:
            high = middle
    return (low + high) / 2.0


def _friction_for(slope: float, offset: float, steps: int) -> float:
    """Return the least friction with which the plant climbs, by halving."""
    low, high = 0.3, 1.0
    for _ in range(steps):
        middle = (low + high) / 2.0
        if _climbed(slope, offset, middle)[1]:
            high = middle
        else:
            low = middle
    return (low + high) / 2.0


def _climbed(slope: float, offset: float, friction: float) -> tuple[float, bool]:
    """Return the rear wheels' slip at the end, and whether the robot still gains height then."""
    parameters = {
        "slope": slope,
        "floor_friction": friction,
        "centre_offset": offset * TOTAL / P["platform_mass"],
        **PLAIN,
    }
    weight = TOTAL * P["gravity"] * math.sin(slope) / 2.0
    start = SPEED / P["wheel_radius"]
    parameters |= {f"speed_{axis}": start * P[f"gear_{axis}"] for axis in ("left", "right")}
    with Plant(**parameters) as plant:
        for _ in range(round(SECONDS * SECOND / STEP)):
            rims = (
                plant[f"speed_{axis}"] * P["wheel_radius"] / P[f"gear_{axis}"] for axis in ("left", "right")
            )
            plant.turn(*(P["wheel_radius"] * (weight + STIFF * (SPEED - rim)) for rim in rims))
        slipping = (plant["slip_ahead_rear_left"] + plant["slip_ahead_rear_right"]) / 2.0
        return slipping, slipping < P["peak_slip"]
