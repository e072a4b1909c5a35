"""RARS by nine coordinates: M q'' + C q' = tau, [R] (3.46)-(3.76), corrected.

q' = (w1, w2, y1', y2', x', psi1', psi2', w4, w5): spins of the rear wheels, their speeds ahead, the rear
axle's to the right, steer rates, spins of the front wheels. tau: motors by torque, and the four tires of
fmu/parts by virtual work. Loads stay those of the standing robot.
"""

from dataclasses import dataclass
from typing import Final

import sympy as sp

from fmu.export.functions import shared
from fmu.export.model import Expression, Input, Model, Output, StateVariable
from fmu.parts.symbols import HALF, inner, symbol, symbols
from fmu.parts.tyre import Tyre
from validation.plants.nine_coordinates.parameters import PARAMETERS

P: Final = symbols(PARAMETERS)
SIDES: Final = {"left": 1, "right": -1}
RATES: Final = ("ahead_left", "ahead_right", "aside")
"""y1', y2' and x' in m/s."""


@dataclass(frozen=True, slots=True)
class Alphas:
    """al1 to al4 of (3.70) in kg; al2 ends in -2 m_w (lam1^2 - lam2 lam3), corrected."""

    one: Expression
    two: Expression
    three: Expression
    four: Expression


def alphas() -> Alphas:
    """Return them for Tab. 3.1's names."""
    track, mass, wheel = P["rear_track"], P["platform_mass"], P["wheel_mass"]
    lam1 = P["wheelbase"] / track
    lam2, lam3 = ((track + sign * P["front_track"]) / 2 / track for sign in (-1, 1))
    turned = (P["yaw_inertia"] + 4 * P["wheel_yaw_inertia"]) / track**2
    share = P["centre_offset"] / track
    quarter = HALF * HALF
    return Alphas(
        turned + mass * (share**2 + quarter) + wheel * (2 * lam1**2 + lam2**2 + lam3**2 + 1),
        -turned + mass * (quarter - share**2) - 2 * wheel * (lam1**2 - lam2 * lam3),
        share * mass + 2 * lam1 * wheel,
        mass + 4 * wheel,
    )


class Wheel:
    """A wheel of both axles: where it points, what its tire does; steer and spin are states."""

    def __init__(self, axle: str, side: str) -> None:
        self.name, self.steered = f"{axle}_{side}", axle == "front"
        self.spin = symbol(f"spin_{self.name}")
        self.ahead = P["wheelbase"] if self.steered else sp.S.Zero
        self.left = SIDES[side] * P[f"{axle}_track"] / 2
        angle = symbol(f"steer_{side}") if self.steered else sp.S.Zero
        self._sine, self._cosine = shared(sp.sin(angle)), shared(sp.cos(angle))
        y1, y2, right = map(symbol, RATES)
        yaw = (y2 - y1) / P["rear_track"]
        forwards, leftwards = HALF * (y1 + y2) - yaw * self.left, yaw * self.ahead - right
        self.tyre = Tyre(
            self.name,
            P,
            rim=P["wheel_radius"] * self.spin,
            back=-forwards * self._cosine - leftwards * self._sine,
            right=forwards * self._sine - leftwards * self._cosine,
        )
        front = P["platform_mass"] * P["centre_offset"] / P["wheelbase"] * HALF
        bears = front if self.steered else P["platform_mass"] * HALF - front
        self.tyre.bears(P["gravity"] * (bears + P["wheel_mass"]))

    def push(self) -> tuple[Expression, Expression, Expression]:
        """Return the forces ahead and to the left in N, the moment about the rear axle's middle in N.m."""
        along, across = self.tyre.force_ahead(), self.tyre.force_left()
        ahead = along * self._cosine - across * self._sine
        left = along * self._sine + across * self._cosine
        return ahead, left, self.ahead * left - self.left * ahead

    def spinning(self) -> StateVariable:
        """Return I_w w' = T - r F."""
        torque = sp.S.Zero if self.steered else symbol(f"torque_{self.name.removeprefix('rear_')}")
        rate = (torque - P["wheel_radius"] * self.tyre.force_ahead()) / P["wheel_spin_inertia"]
        return StateVariable(f"spin_{self.name}", "rad/s", sp.S.Zero, rate)


def accelerations(wheels: list[Wheel]) -> tuple[Expression, ...]:
    """Return y1'', y2'', x'', psi1'' and psi2''."""
    track, upright, by = P["rear_track"], P["wheel_yaw_inertia"], alphas()
    y1, y2, right = map(symbol, RATES)
    yaw = shared((y2 - y1) / track)
    ahead, left, around = (sum(push) for push in zip(*(wheel.push() for wheel in wheels), strict=True))
    torques = [symbol(f"torque_steer_{side}") for side in SIDES]
    half = by.four * HALF
    # The steered wheels' rows, H psi'' = T - H W', put into those of the rear wheels.
    reaction = sum(torques) / track
    one = ahead * HALF - around / track + reaction + yaw * (by.three * y2 - half * right)
    two = ahead * HALF + around / track - reaction - yaw * (by.three * y1 + half * right)
    aside = -left + yaw * half * (y1 + y2)
    turned = 2 * upright / track**2
    total, between = by.one + by.two, by.one - by.two - 2 * turned
    together = shared((one + two) / total)
    # (al1 - al2) (y1 - y2)'' + 2 al3 x'' = one - two, al3 (y1 - y2)'' + al4 x'' = aside.
    determinant = between * by.four - 2 * by.three**2
    apart = shared((by.four * (one - two) - 2 * by.three * aside) / determinant)
    sideways = (between * aside - by.three * (one - two)) / determinant
    yawing = -apart / track
    return (
        HALF * (together + apart),
        HALF * (together - apart),
        sideways,
        *(torque / upright - yawing for torque in torques),
    )


def _energy(wheels: list[Wheel]) -> Expression:
    """Return 1/2 q' M q' and what the tires store, in J."""
    by, track, upright = alphas(), P["rear_track"], P["wheel_yaw_inertia"]
    y1, y2, right = map(symbol, RATES)
    rates = [symbol(f"steer_rate_{side}") for side in SIDES]
    found = by.one * (y1**2 + y2**2) + 2 * by.two * y1 * y2 + 2 * by.three * right * (y1 - y2)
    found += by.four * right**2 + upright * sum(rate**2 for rate in rates)
    found += 2 * upright * sum(rates) * (y2 - y1) / track
    found += P["wheel_spin_inertia"] * sum(wheel.spin**2 for wheel in wheels)
    return HALF * found + sum(wheel.tyre.energy() for wheel in wheels)


def _states(wheels: list[Wheel]) -> tuple[StateVariable, ...]:
    y1, y2, right = map(symbol, RATES)
    heading = symbol("heading")
    speed = HALF * (y1 + y2)
    sine, cosine = sp.sin(heading), sp.cos(heading)
    rates = accelerations(wheels)
    none = (sp.S.Zero, sp.S.Zero)
    return (
        StateVariable("x", "m", sp.S.Zero, speed * cosine + right * sine),
        StateVariable("y", "m", sp.S.Zero, speed * sine - right * cosine),
        StateVariable("heading", "rad", sp.S.Zero, (y2 - y1) / P["rear_track"]),
        *(StateVariable(f"steer_{side}", "rad", sp.S.Zero, symbol(f"steer_rate_{side}")) for side in SIDES),
        *(StateVariable(name, "m/s", sp.S.Zero, rate) for name, rate in zip(RATES, rates[:3], strict=True)),
        *(
            StateVariable(f"steer_rate_{side}", "rad/s", sp.S.Zero, rate)
            for side, rate in zip(SIDES, rates[3:], strict=True)
        ),
        *(wheel.spinning() for wheel in wheels),
        *(state for wheel in wheels for state in wheel.tyre.states(none, wheel.tyre.load)),
    )


def model() -> Model:
    """Return the equations of motion with all tables."""
    wheels = [Wheel(axle, side) for axle in ("rear", "front") for side in SIDES]
    y1, y2, right = map(symbol, RATES)
    return Model(
        name="nine_coordinates",
        description="RARS by nine coordinates, its steered wheels with mass, [R] 3.4",
        parameters=PARAMETERS,
        inputs=tuple(
            Input(f"torque_{name}", "N.m", f"motor torque, {name.replace('_', ' ')}", 1.0)
            for name in ("left", "right", "steer_left", "steer_right")
        ),
        states=_states(wheels),
        outputs=(
            Output("x", "m", "rear axle's middle, world x", symbol("x")),
            Output("y", "m", "rear axle's middle, world y", symbol("y")),
            Output("heading", "rad", "heading, counter-clockwise from world x", symbol("heading")),
            Output("speed", "m/s", "speed of the rear axle's middle, forwards", HALF * (y1 + y2), 0.1),
            Output("yaw_rate", "rad/s", "yaw rate, counter-clockwise", (y2 - y1) / P["rear_track"]),
            inner("drift", "m/s", "speed of the rear axle's middle to the left", -right, 0.1),
            *(
                inner(name, unit, meaning, symbol(name))
                for side in SIDES
                for name, unit, meaning in (
                    (f"steer_{side}", "rad", f"steered wheel's angle, {side}"),
                    (f"steer_rate_{side}", "rad/s", f"steered wheel's rate, {side}"),
                    (f"ahead_{side}", "m/s", f"speed ahead of the rear wheel, {side}"),
                )
            ),
            inner("aside", "m/s", "speed of the rear axle to the right", right),
            *(
                inner(f"spin_{it.name}", "rad/s", f"spin, {it.name.replace('_', ' ')}", it.spin)
                for it in wheels
            ),
            *(row for wheel in wheels for row in wheel.tyre.readings()),
            inner("energy", "J", "energy stored in the whole robot", _energy(wheels), 10.0),
        ),
        inner_step=100e-6,
    )
