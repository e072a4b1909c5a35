"""A castor: it swivels about its pivot, its wheel trails behind and rolls without side slip.

It has no mass: the floor pushes at it only as its rolling resistance and the friction of its swivel ask for.
"""

from dataclasses import dataclass

import sympy as sp

from fmu.export.functions import shared
from fmu.export.model import Expression, Output, StateVariable
from fmu.parts.motor import bristle
from fmu.parts.planar import PlanarBody, Push
from fmu.parts.symbols import HALF, inner, symbol


@dataclass(frozen=True, slots=True)
class CastorFriction:
    """Two dry frictions as bristles: levels in N and N.m, and what they build up over in m and rad."""

    rolling: Expression
    swivel: Expression
    rolling_presliding: Expression
    swivel_presliding: Expression


class Castor:
    """Its pivot is fixed in the body, `ahead` and `left` of the origin; `trail`: pivot to contact; all in m.

    The swivel's angle is that of the wheel's way in the body, positive to the left; at 0 it trails behind.
    """

    def __init__(
        self,
        name: str,
        body: PlanarBody,
        friction: CastorFriction,
        *,
        ahead: Expression,
        left: Expression,
        trail: Expression,
    ) -> None:
        self.name = name
        self._friction, self._ahead, self._left, self._trail = friction, ahead, left, trail
        self.angle = symbol(f"swivel_{name}")
        self._rolled, self._swivelled = symbol(f"rolling_{name}"), symbol(f"swivelling_{name}")
        self._sine, self._cosine = shared(sp.sin(self.angle)), shared(sp.cos(self.angle))
        forwards, sideways = map(shared, body.velocity(ahead, left))
        self.speed = shared(forwards * self._cosine + sideways * self._sine)
        # The contact does not slip sideways, and the swivel turns in the body.
        self.turning = shared((sideways * self._cosine - forwards * self._sine) / trail - body.yaw_rate)

    def push(self) -> Push:
        """Return what the floor does to the body; with the swivel's own torque it takes out power only."""
        torque = self._friction.swivel * self._swivelled
        # Massless: the side force is what balances the swivel's friction about the pivot.
        along, across = -self._friction.rolling * self._rolled, -torque / self._trail
        ahead = along * self._cosine - across * self._sine
        left = along * self._sine + across * self._cosine
        return Push(ahead, left, self._ahead * left - self._left * ahead + torque)

    def states(self) -> tuple[StateVariable, ...]:
        """Return the swivel's angle and both bristles."""
        friction = self._friction
        rolling = bristle(self.speed, self._rolled, friction.rolling_presliding)
        swivelling = bristle(self.turning, self._swivelled, friction.swivel_presliding)
        return (
            StateVariable(f"swivel_{self.name}", "rad", sp.S.Zero, self.turning),
            StateVariable(f"rolling_{self.name}", "1", sp.S.Zero, rolling),
            StateVariable(f"swivelling_{self.name}", "1", sp.S.Zero, swivelling),
        )

    def readings(self) -> tuple[Output, ...]:
        """Return the swivel's angle for people and tests."""
        title = self.name.replace("_", " ")
        return (inner(f"swivel_{self.name}", "rad", f"swivel's angle in the body, {title}", self.angle),)

    def energy(self) -> Expression:
        """Return the energy of both bristles in J."""
        friction = self._friction
        rolling = friction.rolling * friction.rolling_presliding * self._rolled**2
        return HALF * (rolling + friction.swivel * friction.swivel_presliding * self._swivelled**2)
