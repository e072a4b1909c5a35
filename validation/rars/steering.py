"""The steering's step under computed torque, and what 10 % of error in its model do, [R] 3.5.

Ours is the plant's rack behind its motor; the independent way is the closed form of (3.102), corrected, whose
gains are those of the regulator times the model's error.
"""

import math
from collections.abc import Mapping
from functools import cache
from typing import Final

import numpy as np

from firmware_bridge.motion.davis import rack_from_steer
from firmware_bridge.robot_types import find
from validation.rars.plant import P, Plant
from validation.studies.solve import Floats, root
from validation.studies.study import Compared, Curve, Findings, Plot, Style

KD, KP, KI = 20.0, 60.0, 100.0
"""1/s, 1/s2, 1/s3: of the rack's acceleration, no gains of a drive."""
STEP_DEG: Final = 30.0
ERRORS: Final = (0.9, 1.0, 1.1)
"""The model's inertia over the plant's."""
LINE: Final[Style] = "line"
POINTS: Final[Style] = "points"
DT: Final = 1e-4
EVERY: Final = 100
QUIET: Final = {"coulomb_steer": 0.0, "viscous_steer": 0.0, "tyre_torque": 0.0}
AXIS: Final = "angle from standstill to a step of 30° of the inner wheel"
PRINTED_ORDER: Final = (
    "In print the last row of (3.102) exchanges Kp and Kd: its swing would decay by 0.15/s, not 1.6/s."
)
ROTOR: Final = (
    "Seen from the rack the motor's rotor weighs fifty times what hangs on the rack, (3.97): the error is "
    "taken of both together. The regulator works every 0.1 ms (assumed: the source gives no rate)."
)
DRY: Final = (
    "With the tyres' 0.4 N.m a wheel and the motor's dry friction the integral term has to find both. Where "
    "it is compensated, it is added with the sign of the speed, and at rest of the wanted acceleration."
)


def steering(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    seconds = 3.0 if quick else 6.0
    aim = rack_from_steer(find("rars").geometry.base, math.radians(STEP_DEG))
    times = np.arange(0.0, seconds, DT * EVERY)
    closed = {error: response(error, times) for error in ERRORS}
    ours = {error: _driven(error, seconds, aim, compensated=False, dry=False) / aim for error in ERRORS}
    rough = _driven(1.0, seconds, aim, compensated=False, dry=True) / aim
    smooth = _driven(1.0, seconds, aim, compensated=True, dry=True) / aim
    return Findings(
        compared=(
            *(
                Compared(
                    f"overshoot with {100 * error:.0f} % of the inertia in the model",
                    "%",
                    None,
                    100.0 * (closed[error].max() - 1.0),
                    100.0 * (ours[error].max() - 1.0),
                    0.1,
                    "the winding's 0.1 ms and the regulator's cycle",
                )
                for error in ERRORS
            ),
            *(
                Compared(
                    f"largest distance from the closed form, {100 * error:.0f} %",
                    "% of the step",
                    None,
                    0.0,
                    100.0 * float(np.abs(ours[error] - closed[error]).max()),
                    0.2,
                    "as above",
                )
                for error in ERRORS
            ),
            Compared(
                "decay of the slowest swing",
                "1/s",
                _decay(KD, KI, KP),
                _decay(KP, KI, KD),
                _measured(times, ours[1.0]),
                0.05,
                "the print's order of gains is wrong: what follows from it stands under printed",
            ),
        ),
        plots=(
            Plot(
                "Rack after a step, without friction",
                "time [s]",
                "rack over the step [1]",
                (
                    Curve("(3.102) corrected", times, closed[1.0]),
                    Curve("plant", times[::12], ours[1.0][::12], "points"),
                    Curve("(3.102) as printed", times, response(1.0, times, printed=True), "dots"),
                ),
                f"Computed torque (3.99) to (3.101), Kd = 20, Kp = 60, Ki = 100; {AXIS}.",
            ),
            Plot(
                "What 10 % of error in the model's inertia change",
                "time [s]",
                "difference from the exact model [% of the step]",
                tuple(
                    Curve(f"{name}, {100 * error:.0f} %", times[::many], _apart(found, error)[::many], style)
                    for name, found, style, many in (
                        ("(3.102) corrected", closed, LINE, 1),
                        ("plant", ours, POINTS, 12),
                    )
                    for error in (0.9, 1.1)
                ),
                "The gains act as if multiplied by the error: the step changes by some 1 %.",
            ),
            Plot(
                "Rack after a step, on the floor",
                "time [s]",
                "rack over the step [1]",
                (
                    Curve("friction not in the model", times, rough),
                    Curve("friction compensated", times, smooth),
                    Curve("without friction, closed form", times, closed[1.0], "dashed"),
                ),
                f"The same with the friction of (2.14) and of the motor; {AXIS}.",
            ),
        ),
        remarks=(PRINTED_ORDER, ROTOR, DRY),
    )


def _apart(found: Mapping[float, Floats], error: float) -> Floats:
    """Return by how much a wrong model changes the rack, in % of the step."""
    return 100.0 * (found[error] - found[1.0])


def response(error: float, times: Floats, *, printed: bool = False) -> Floats:
    """Return the rack over the step: Y' = A Y of (int e, e, e'), by its eigenvectors."""
    row = (KI, KD, KP) if printed else (KI, KP, KD)
    loop = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-error * each for each in row]])
    values, vectors = np.linalg.eig(loop)
    shares = np.linalg.solve(vectors, np.array([0.0, -1.0, 0.0], dtype=complex))
    error_then: Floats = (vectors[1] * shares * np.exp(np.outer(times, values))).sum(axis=1).real
    return 1.0 + error_then


def _decay(proportional: float, integral: float, derivative: float) -> float:
    """Return how fast the swing of s3 + Kd s2 + Kp s + Ki decays: its real root, and what Vieta leaves."""
    real = root(lambda s: s**3 + derivative * s * s + proportional * s + integral, -2.0 * derivative, -5.0)
    return (derivative + real) / 2.0


def _measured(times: Floats, rack: Floats) -> float:
    """Return the same from the first peak over 1 to the dip below it."""
    peak = int(np.argmax(rack))
    dip = peak + int(np.argmin(rack[peak:]))
    return math.log((rack[peak] - 1.0) / (1.0 - rack[dip])) / float(times[dip] - times[peak])


@cache
def _driven(error: float, seconds: float, aim: float, *, compensated: bool, dry: bool) -> Floats:
    """Return the plant's rack in m, every 10 ms, under the regulator."""
    parameters = {} if dry else QUIET
    model, found, integral = _Model(), [], 0.0
    with Plant(**parameters) as plant:
        for place in range(round(seconds / DT)):
            rack, speed = plant["rack"], plant["speed_steer"] * model.ratio
            if place % EVERY == 0:
                found.append(rack)
            integral += (rack - aim) * DT
            wanted = -KD * speed - KP * (rack - aim) - KI * integral
            force = error * (model.mass(rack) * wanted + model.convection(rack) * speed**2)
            if compensated:
                moves = speed if abs(speed) > model.CREEPS else wanted
                force += math.copysign(model.dry(rack), moves)
            current = force * model.ratio / P["torque_constant_steer"]
            plant.steer(P["resistance_steer"] * current + P["torque_constant_steer"] * plant["speed_steer"])
            plant.rests(DT)
    return np.array(found)


class _Model:
    """(3.96) to (3.98) corrected, in numbers, with the rotor: what the regulator believes."""

    CREEPS: Final = 1e-4

    def __init__(self) -> None:
        self.h = P["davis_h"]
        self.b = self.h * P["kingpin_distance"] / (2.0 * P["wheelbase"])
        self.ratio = P["pinion_diameter"] / (2.0 * P["gear_steer"])
        self.inertia = P["link_mass"] * P["link_centre"] ** 2 + P["link_inertia"]
        self.inertia += P["kingpin_offset"] ** 2 * P["front_wheel_mass"]

    def _turns(self, rack: float) -> tuple[float, float]:
        return tuple(self.h / (self.h**2 + (self.b + side * rack) ** 2) for side in (1.0, -1.0))  # type: ignore[return-value]

    def mass(self, rack: float) -> float:
        """Return the mass at the rack in kg."""
        turns = sum(turn**2 for turn in self._turns(rack))
        return P["tie_rod_mass"] + self.inertia * turns + P["rotor_inertia_steer"] / self.ratio**2

    def convection(self, rack: float) -> float:
        """Return what stands beside the speed squared, kg/m."""
        bends = zip(self._turns(rack), (1.0, -1.0), strict=True)
        return self.inertia * sum(
            -2.0 * side * (self.b + side * rack) * turn**3 / self.h for turn, side in bends
        )

    def dry(self, rack: float) -> float:
        """Return tyres and motor's dry friction at the rack in N."""
        return P["tyre_torque"] * sum(self._turns(rack)) + P["coulomb_steer"] / self.ratio
