"""One tire on the floor: slip, adhesion by the corrected (3.83), and a bristle that holds at rest.

The tire's deflection z grows with the slip velocity and is wiped off as the wheel rolls on: its steady state
is (3.83) over the slip of [R] 3.4.3, both corrected, and sideways over the slip angle atan(v_t / v_l) below
(3.76); at rest it is a spring, so nothing creeps. Whatever the
load does, it takes energy out and adds none. [R] is that of fmu/rars. It does not depend on whose
wheel it is.
"""

from collections.abc import Mapping

import sympy as sp

from fmu.export.functions import angle, clamped, larger, positive_part, reciprocal, shared, size
from fmu.export.model import Expression, Output, StateVariable
from fmu.parts.symbols import HALF, inner, symbol

FALL = sp.Rational(34, 100)
"""(3.83): adhesion falls by this share of its peak from the peak to a slip of 1."""


LAG = sp.Float(50e-6)
"""Shortest time in s in which a deflection is wiped off: half an inner step, to be stable in every slide."""
TRACE = sp.Float(1e-6)
"""N added to each grip, so that nothing is divided by zero on ice or under a lifted wheel."""
REST = sp.Float(1e-12)
"""m/s added to each slip, so that nothing is divided by zero at rest."""


class Tyre:
    """A wheel's contact; `name` names its states, `tyre_rows` its parameters.

    Speeds in m/s: the rim's, and those of the floor as the wheel sees it, backwards and to the right.
    """

    def __init__(
        self,
        name: str,
        parameters: Mapping[str, Expression],
        *,
        rim: Expression,
        back: Expression,
        right: Expression,
    ) -> None:
        self.name = name
        self._p = parameters
        self.spring_ahead = shared(self._p["tyre_stiffness"] * symbol(f"tyre_ahead_{name}"))
        self.spring_left = shared(self._p["tyre_stiffness"] * symbol(f"tyre_left_{name}"))
        rim, back, right = map(shared, (rim, back, right))
        self._slipping = (shared(rim + back), right)
        self._springs = (self.spring_ahead, self.spring_left)
        # max(|r w|, |v|), the corrected denominator; the print takes the signed one.
        self._rolling = larger(size(back), size(rim))
        self._over = larger(self._rolling, self._p["slip_speed"])
        # Over v_l alone, whatever the rim does.
        self._angle = shared(angle(right, larger(size(back), self._p["slip_speed"])))
        self._load: Expression = None
        self._grip: Expression = None

    def bears(self, load: Expression) -> None:
        """Give the tire its load in N."""
        self._load = positive_part(load)
        self._grip = self._p["floor_friction"] * self._load + TRACE

    @property
    def load(self) -> Expression:
        """The load in N."""
        return self._load

    def slips(self) -> tuple[Expression, Expression]:
        """Return the slip ahead (rho), slip velocity over rolling speed, and the slip angle, to the left."""
        return self._slipping[0] / self._over, self._angle

    def force_ahead(self) -> Expression:
        """Return the force on the robot along the wheel's way in N."""
        return self._force(0)

    def force_left(self) -> Expression:
        """Return the force on the robot along the wheel's axle in N."""
        return self._force(1)

    def states(self, hold: tuple[Expression, Expression], load: Expression) -> tuple[StateVariable, ...]:
        """Return the deflections; they start with the forces `hold`, as far as the standing load grips."""
        grip = self._p["floor_friction"] * load
        ahead, left = (clamped(force, grip) / self._p["tyre_stiffness"] for force in hold)
        return tuple(
            StateVariable(f"tyre_{way}_{self.name}", "m", start, self._stretching(i))
            for i, (way, start) in enumerate((("ahead", ahead), ("left", left)))
        )

    def readings(self) -> tuple[Output, ...]:
        """Return load, slips, forces and deflections for people and tests."""
        name, title = self.name, self.name.replace("_", " ")
        ahead, left = self.slips()
        z_ahead, z_left = symbol(f"tyre_ahead_{name}"), symbol(f"tyre_left_{name}")
        along, across = f"along its way, {title}", f"along its axle, {title}"
        return (
            inner(f"load_{name}", "N", f"load of the wheel, {title}", self.load, 100.0),
            inner(f"slip_ahead_{name}", "1", f"slip along the wheel's way, {title}", ahead, 0.1),
            inner(f"slip_left_{name}", "rad", f"slip angle, to the left of the wheel, {title}", left, 0.1),
            inner(f"force_ahead_{name}", "N", f"tyre's force {along}", self.force_ahead(), 10.0),
            inner(f"force_left_{name}", "N", f"tyre's force {across}", self.force_left(), 10.0),
            inner(f"tyre_ahead_{name}", "m", f"tyre's deflection {along}", z_ahead, 1e-4),
            inner(f"tyre_left_{name}", "m", f"tyre's deflection {across}", z_left, 1e-4),
        )

    def energy(self) -> Expression:
        """Return the energy of the deflections in J."""
        return HALF * (self.spring_ahead**2 + self.spring_left**2) / self._p["tyre_stiffness"]

    def _force(self, way: int) -> Expression:
        """Return F = k z + (2 e + c) z' - e v_slip, in steady state (3.83); e is 0 but where LAG holds back.

        With a, z's rate of decay, no energy is gained while 4 (c + e) (k - e a) >= c^2 a: c fades with slip,
        and sooner where LAG holds back.
        """
        excess = self._p["tyre_stiffness"] * LAG * (1 - self._held_back(way))
        # 1 at rest, where the tire is a spring.
        fade = positive_part(self._held_back(way) - self._p["tyre_damping"] * self._loose(way))
        wiped, stretching = self._wiped(way), self._stretching(way)
        return (
            self._springs[way]
            + self._p["tyre_damping"] * fade**2 * stretching
            + excess * (stretching - wiped)
        )

    def _stretching(self, way: int) -> Expression:
        """Return z' = v_slip - k z D / (mu N): a steady slide is held by mu N v_slip / D."""
        return shared(self._slipping[way] - self._wiped(way))

    def _wiped(self, way: int) -> Expression:
        """Return how fast the deflection is wiped off in m/s, k z D / (mu N), not sooner than in LAG."""
        return shared(self._springs[way] * self._loose(way))

    def _loose(self, way: int) -> Expression:
        """Return D / (mu N) in m/(N.s), not more than LAG allows."""
        return shared(self._slide(way)[0] * self._per_hold(way))

    def _held_back(self, way: int) -> Expression:
        """Return the share of the wiping that LAG allows, 1 where it is slow enough."""
        return shared(self._slide(way)[1] * self._per_hold(way))

    def _per_hold(self, way: int) -> Expression:
        slide, hold = self._slide(way)
        return reciprocal(larger(self._p["tyre_stiffness"] * LAG * slide, hold))

    def _slide(self, way: int) -> tuple[Expression, Expression]:
        """Return D and mu N, both times the same: so no division has to wait for another one.

        D in m/s: slip velocity over lambda x peak slip up to the peak, over (3.83)'s share beyond; lambda is
        (rho, slip angle). Both forces share one D, so that they oppose the slip velocity.
        """
        peak, over = self._p["peak_slip"], self._over
        speed = self._both(self._slipping, way)
        slip = self._both((self._slipping[0], shared(self._angle * over)), way)  # lambda, times `over`
        beyond = positive_part(slip - peak * over)
        # (3.83) beyond the peak; adhesion does not fall further than at a slip of 1.
        share = larger(over - FALL / (1 - peak) * beyond, (1 - FALL) * over)
        return speed * larger(peak * self._rolling * share, slip * over), slip * self._grip * share

    def _both(self, ways: tuple[Expression, Expression], way: int) -> Expression:
        """Return the size of both together on a friction circle, else that of this way; above 0."""
        # A parameter, not a branch: both laws are in the same equations, and no event is needed between them.
        circle = self._p["friction_circle"]
        together = sp.sqrt(ways[0] ** 2 + ways[1] ** 2)
        return shared(circle * together + (1 - circle) * size(ways[way]) + REST)
