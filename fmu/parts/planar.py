"""A rigid body on a floor, in its own frame: where it is, how it moves, what forces do to it.

Its origin lies on its long axis, the center of mass some way ahead of it. Not known here: what it stands on.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp

from fmu.export.model import Expression, Output, StateVariable
from fmu.parts.symbols import HALF, inner, symbol


@dataclass(frozen=True, slots=True)
class Push:
    """Effect of the floor on a body: forces ahead and to the left in N, moment about its origin in N.m."""

    ahead: Expression
    left: Expression
    moment: Expression


class PlanarBody:
    """u ahead and q to the left of the origin, W the yaw rate to the left; all wheels' masses included.

    `mass` in kg, `offset_mass` = mass times way from the origin to the center of mass in kg.m, `inertia`
    about the origin in kg.m2, `downhill` = g sin(slope) in m/s2, against x of the world.
    """

    def __init__(
        self, *, mass: Expression, offset_mass: Expression, inertia: Expression, downhill: Expression
    ) -> None:
        self.mass, self.offset_mass, self.inertia, self.downhill = mass, offset_mass, inertia, downhill
        self.heading, self.speed, self.drift, self.yaw_rate = map(
            symbol, ("heading", "speed", "drift", "yaw_rate")
        )

    def velocity(self, ahead: Expression, left: Expression) -> tuple[Expression, Expression]:
        """Return the speed ahead and to the left of the point that lies so far ahead and to the left."""
        return self.speed - self.yaw_rate * left, self.drift + self.yaw_rate * ahead

    def accelerations(self, pushes: Iterable[Push]) -> tuple[Expression, Expression, Expression]:
        """Return u', q', W' under these pushes and the slope.

        m (u' - q W) - m a W2 = F_u, m (q' + u W) + m a W' = F_q, I W' + m a (q' + u W) = F_W.
        """
        sine, cosine = sp.sin(self.heading), sp.cos(self.heading)
        # In the body's own frame: the slope's force and the centrifugal one of the offset mass.
        ahead = self.offset_mass * self.yaw_rate**2 - self.mass * self.downhill * cosine
        left = self.mass * self.downhill * sine
        around = self.offset_mass * self.downhill * sine
        for push in pushes:
            ahead, left, around = ahead + push.ahead, left + push.left, around + push.moment
        # The 2 x 2 mass matrix of q' and W', which the offset of the center of mass couples.
        determinant = self.mass * self.inertia - self.offset_mass**2
        return (
            ahead / self.mass + self.drift * self.yaw_rate,
            self.inertia / determinant * left
            - self.offset_mass / determinant * around
            - self.speed * self.yaw_rate,
            self.mass / determinant * around - self.offset_mass / determinant * left,
        )

    def states(
        self, pushes: Iterable[Push], start: tuple[Expression, Expression] = (sp.S.Zero, sp.S.Zero)
    ) -> tuple[StateVariable, ...]:
        """Return pose and motion; `start` is the speed ahead and the yaw rate that it starts with."""
        sine, cosine = sp.sin(self.heading), sp.cos(self.heading)
        speed_rate, drift_rate, yaw_acceleration = self.accelerations(pushes)
        return (
            StateVariable("x", "m", sp.S.Zero, self.speed * cosine - self.drift * sine),
            StateVariable("y", "m", sp.S.Zero, self.speed * sine + self.drift * cosine),
            StateVariable("heading", "rad", sp.S.Zero, self.yaw_rate),
            StateVariable("speed", "m/s", start[0], speed_rate),
            StateVariable("drift", "m/s", sp.S.Zero, drift_rate),
            StateVariable("yaw_rate", "rad/s", start[1], yaw_acceleration),
        )

    def outputs(self, origin: str) -> tuple[Output, ...]:
        """Return pose and motion as readings; `origin` is what stands there, as "rear axle's middle"."""
        return (
            Output("x", "m", f"{origin}, world x", symbol("x")),
            Output("y", "m", f"{origin}, world y", symbol("y")),
            Output("heading", "rad", "heading, counter-clockwise from world x", self.heading),
            Output("speed", "m/s", f"speed of the {origin}, forwards", self.speed, 0.1),
            Output("yaw_rate", "rad/s", "yaw rate, counter-clockwise", self.yaw_rate),
            inner("drift", "m/s", f"speed of the {origin} to the left", self.drift, 0.1),
        )

    def energy(self) -> Expression:
        """Return the energy of motion and height in J."""
        kinetic = self.mass * (self.speed**2 + self.drift**2) + self.inertia * self.yaw_rate**2
        # The origin is not the center of mass: speeds and yaw rate share this term.
        kinetic += 2 * self.offset_mass * self.drift * self.yaw_rate
        climb = self.mass * symbol("x") + self.offset_mass * sp.cos(self.heading)
        return HALF * kinetic + self.downhill * climb
