"""Two driven wheels and two castors with mass: I th'' = tau - C th', [R] (3.13)-(3.40), corrected.

Nothing slips: two speeds decide all. Corrected: pivot minus wheel is d1 e - d2 f in (3.21), (3.28); (3.25)
has -m S; (3.27) has its rows exchanged. A trail of 0 needs a motor on the swivel: P has no inverse then.
"""

from collections.abc import Sequence
from typing import Final

import sympy as sp

from fmu.export.functions import shared
from fmu.export.model import Expression, Input, Model, Output, StateVariable
from fmu.parts.symbols import HALF, inner, symbol, symbols
from validation.plants.castors.parameters import PARAMETERS

P: Final = symbols(PARAMETERS)
SIDES: Final = {"left": -1, "right": 1}
"""Along i, to the right."""
Pair = tuple[Expression, Expression]
"""By the left and the right driven wheel's speed."""
AHEAD: Final[Pair] = (P["wheel_radius"] * HALF, P["wheel_radius"] * HALF)
YAW: Final[Pair] = (-P["wheel_radius"] / P["rear_track"], P["wheel_radius"] / P["rear_track"])


def _dot(pair: Pair) -> Expression:
    return pair[0] * symbol("spin_left") + pair[1] * symbol("spin_right")


def _both(*terms: tuple[Expression, Pair]) -> Pair:
    """Return the sum of pairs, each times its factor, each element computed once."""
    left, right = (shared(sum(factor * pair[place] for factor, pair in terms)) for place in (0, 1))
    return left, right


class HeavyCastor:
    """A castor: how fast it rolls and turns over the floor by the driven wheels' speeds."""

    def __init__(self, side: str) -> None:
        self.name, angle = side, symbol(f"swivel_{side}")
        sine, cosine = shared(sp.sin(angle)), shared(sp.cos(angle))
        radius, across, trail = P["wheel_radius"], P["castor_across"], P["castor_trail"]
        sideways = _both((-(P["centre_offset"] + P["pivots_ahead"]), YAW))
        along = _both((sp.S.One, AHEAD), (SIDES[side] * P["pivot_aside"], YAW))
        self.turning = _both((cosine / trail, sideways), (sine / trail, along))
        self.rolling = _both(
            (cosine / radius, along), (-sine / radius, sideways), (-across / radius, self.turning)
        )
        self.swivelling = shared(_dot(self.turning) - _dot(YAW))
        # d/dt of both by the swivel: e' = psi' f, f' = -psi' e.
        turn = self.swivelling
        self._turns_on = _both((turn * radius / trail, self.rolling), (turn * across / trail, self.turning))
        self._rolls_on = _both((-turn * trail / radius, self.turning), (-across / radius, self._turns_on))

    def inertia(self, row: int, column: int) -> Expression:
        """Return its part of I in kg.m2: a disc, half its mass about the axle, a quarter upright."""
        return self._summed(row, column, self.rolling, self.turning)

    def coriolis(self, row: int, column: int) -> Expression:
        """Return its part of C in kg.m2/s."""
        return self._summed(row, column, self._rolls_on, self._turns_on)

    def _summed(self, row: int, column: int, rolls: Pair, turns: Pair) -> Expression:
        each = P["castor_mass"] * P["wheel_radius"] ** 2 / 4
        return each * (6 * self.rolling[row] * rolls[column] + self.turning[row] * turns[column])


def inertia(castors: Sequence[HeavyCastor]) -> tuple[Expression, Expression, Expression]:
    """Return I's elements (1,1), (1,2) and (2,2) in kg.m2."""
    lam = P["wheel_radius"] / P["rear_track"]
    yaw = 2 * lam**2 * P["wheel_yaw_inertia"]
    rear = P["wheel_spin_inertia"] + P["wheel_mass"] * P["wheel_radius"] ** 2 + yaw
    body = (P["platform_mass"] * P["centre_offset"] ** 2 + P["yaw_inertia"]) * lam**2
    mean = P["platform_mass"] * P["wheel_radius"] ** 2 / 4
    own, between = rear + mean + body, mean - body - yaw
    first, mixed, second = (
        shared(start + sum(castor.inertia(*place) for castor in castors))
        for start, place in ((own, (0, 0)), (between, (0, 1)), (own, (1, 1)))
    )
    return first, mixed, second


def accelerations(castors: Sequence[HeavyCastor]) -> Pair:
    """Return the driven wheels' in rad/s2."""
    left, right = symbol("spin_left"), symbol("spin_right")
    pull = P["platform_mass"] * P["centre_offset"] * P["wheel_radius"] ** 3 / P["rear_track"] ** 2
    turned = shared(pull * (left - right))
    rest = [symbol("torque_left") - turned * right, symbol("torque_right") + turned * left]
    for row in (0, 1):
        for castor in castors:
            rest[row] -= castor.coriolis(row, 0) * left + castor.coriolis(row, 1) * right
    one, two = map(shared, rest)
    first, mixed, second = inertia(castors)
    determinant = shared(first * second - mixed**2)
    return (second * one - mixed * two) / determinant, (first * two - mixed * one) / determinant


def model() -> Model:
    """Return the equations of motion with all tables."""
    castors = [HeavyCastor(side) for side in SIDES]
    heading, left, right = map(symbol, ("heading", "spin_left", "spin_right"))
    speed, yaw_rate = shared(_dot(AHEAD)), shared(_dot(YAW))
    first, mixed, second = inertia(castors)
    spins = zip(SIDES, accelerations(castors), strict=True)
    return Model(
        name="castors",
        description="Two driven wheels and two castors with mass, nothing slips, [R] 3.2, 3.3",
        parameters=PARAMETERS,
        inputs=tuple(Input(f"torque_{side}", "N.m", f"motor torque, {side} wheel", 1.0) for side in SIDES),
        states=(
            *(StateVariable(f"swivel_{it.name}", "rad", sp.S.Zero, it.swivelling) for it in castors),
            *(StateVariable(f"spin_{side}", "rad/s", sp.S.Zero, rate) for side, rate in spins),
            StateVariable("x", "m", sp.S.Zero, speed * sp.cos(heading)),
            StateVariable("y", "m", sp.S.Zero, speed * sp.sin(heading)),
            StateVariable("heading", "rad", sp.S.Zero, yaw_rate),
        ),
        outputs=(
            Output("x", "m", "axle's middle, world x", symbol("x")),
            Output("y", "m", "axle's middle, world y", symbol("y")),
            Output("heading", "rad", "heading, counter-clockwise from world x", heading),
            Output("speed", "m/s", "speed of the axle's middle, forwards", speed, 0.1),
            Output("yaw_rate", "rad/s", "yaw rate, counter-clockwise", yaw_rate),
            *(
                inner(f"swivel_{it.name}", "rad", f"swivel's angle, {it.name}", symbol(f"swivel_{it.name}"))
                for it in castors
            ),
            *(
                inner(f"spin_{side}", "rad/s", f"spin of the {side} wheel", symbol(f"spin_{side}"))
                for side in SIDES
            ),
            *(
                inner(f"rolling_{it.name}", "rad/s", f"castor's spin, {it.name}", _dot(it.rolling))
                for it in castors
            ),
            inner(
                "energy",
                "J",
                "energy of all motion",
                HALF * (first * left**2 + second * right**2) + mixed * left * right,
                1.0,
            ),
        ),
        inner_step=100e-6,
    )
