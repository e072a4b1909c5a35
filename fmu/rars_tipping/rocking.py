"""Rotation of a rigid robot about the low or the high edge of what it stands on, in one direction.

As long as the zero-moment point (ZMP) lies between the edges, the floor pushes there and nothing turns.
Past an edge the floor pushes at that edge, and the robot turns about it as an inverted pendulum.
"""

from typing import Final

import sympy as sp

from fmu.export.functions import clamped, named, passed, positive_part, reciprocal, shared, size
from fmu.export.model import Expression, StateVariable
from fmu.parts.symbols import symbol
from fmu.rars_tipping.symbols import P

STANDS: Final = sp.Float(400.0)
"""1/s: how fast a rotation ends on all wheels, as on a stiff floor (assumed)."""
LANDS: Final = sp.Float(5e-3)
"""rad before standing within which an impact takes the speed out: 2 mm at a wheel (assumed)."""
IMPACT: Final = sp.Float(100.0) / LANDS
"""1/rad: the speed falls by exp(-5) over `LANDS`: no restitution (assumed)."""
FALLS: Final = sp.Float(15.0)
"""1/s: how fast a robot that has tipped comes to lie (assumed)."""


class Rocking:
    """`angle` in rad, positive: the high side is up, and the robot turns about the low edge.

    `centre` of mass between the edges and its `height` over the floor, of the standing robot, in m;
    `inertia` about the centre of mass in kg m2, `mass` in kg, `weight` on the floor in N.
    """

    def __init__(
        self, name: str, centre: Expression, height: Expression, *, mass: Expression, inertia: Expression
    ) -> None:
        self.name = name
        self.angle, self.rate = symbol(name), symbol(f"{name}_rate")
        self._centre, self._height, self._mass, self._inertia = centre, height, mass, inertia
        self.passed = passed(size(self.angle) - P["tip_angle"])
        self.zmp: Expression = None
        self.contact: Expression = None
        self._weight: Expression = None

    def stands(self, low: Expression, high: Expression, *, force: Expression, weight: Expression) -> None:
        """Set its edges in m, and the floor's `force` in this direction, positive to the high edge, in N."""
        sine, cosine = shared(sp.sin(self.angle)), shared(sp.cos(self.angle))
        up, down = shared(positive_part(sine)), shared(positive_part(-sine))
        to_low, to_high = self._centre - low, high - self._centre
        # 1 - cos = sin^2 / (1 + cos): of the second order, and without a branch between both edges.
        bent = reciprocal(1 + cosine)
        centre = self._centre - self._height * sine + (to_high * down**2 - to_low * up**2) * bent
        height = self._height * cosine + to_low * up + to_high * down
        self.zmp = named(centre - height * force / weight)
        # Within the edges it is held by what the floor gives: a spring and a damper that never pull.
        lean = self._about(sp.S.Zero) / weight * STANDS * (STANDS * self.angle + 4 * self.rate)
        middle, half = (high + low) / 2, (high - low) / 2
        self.contact = named(middle + clamped(self.zmp - lean - middle, half))
        self._weight = weight

    def states(self, lies: Expression) -> tuple[StateVariable, ...]:
        """Return angle and rate; `lies` is 1 where the robot has tipped over, in either direction."""
        around = self._about(self._centre - self.contact)
        turning = self._weight * (self.contact - self.zmp) / around + self._impact()
        side = clamped(1000 * self.angle, sp.S.One)
        # Beyond the tip angle it only falls on: no input brings it back.
        falling = FALLS**2 * (side * sp.pi / 2 - self.angle) * self.passed
        rate = (1 - lies) * turning + falling - lies * 2 * FALLS * self.rate
        return (
            StateVariable(self.name, "rad", sp.S.Zero, self.rate),
            StateVariable(f"{self.name}_rate", "rad/s", sp.S.Zero, rate),
        )

    def energy(self) -> Expression:
        """Return the energy of the rotation in J, without the height that it gains."""
        return self._about(self._centre - self.contact) * self.rate**2 / 2

    def _about(self, lever: Expression) -> Expression:
        """Return the inertia about a point on the floor, `lever` aside of the centre of mass."""
        return self._inertia + self._mass * (lever**2 + self._height**2)

    def _impact(self) -> Expression:
        """Return what an impact takes out of the speed back to the floor, in rad/s2; 0 on the way up."""
        near = shared(clamped(self.angle / LANDS, sp.S.One))
        return IMPACT * near * (1 - size(near)) * positive_part(-near * self.rate) ** 2
