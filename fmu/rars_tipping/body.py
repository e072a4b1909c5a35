"""The planar body of a robot whose centre of mass lies off its long axis, on a slope of any direction."""

from collections.abc import Iterable
from typing import Final

import sympy as sp

from fmu.export.functions import shared
from fmu.export.model import Expression
from fmu.parts.planar import PlanarBody, Push
from fmu.parts.symbols import HALF, symbol
from fmu.rars_tipping.masses import Masses
from fmu.rars_tipping.symbols import P

SLIDES_ON: Final = sp.Float(0.1)
"""s in which a robot that lies on the floor loses its speed (assumed)."""


class LoadedBody(PlanarBody):
    """PlanarBody with a moment of mass to the left in kg.m; `lies` is 1 where the robot has tipped over."""

    def __init__(self, masses: Masses, lies: Expression) -> None:
        super().__init__(
            mass=masses.total,
            offset_mass=masses.moment_ahead,
            inertia=masses.yaw_inertia(),
            downhill=P["gravity"] * sp.sin(P["slope"]),
        )
        self._ahead, self._left = masses.ahead, masses.left
        self._side_mass, self._lies = masses.moment_left, lies
        self._central = self.inertia - self.mass * (self._ahead**2 + self._left**2)
        uphill = self.heading - P["slope_heading"]
        self.uphill_ahead, self.uphill_right = shared(sp.cos(uphill)), shared(sp.sin(uphill))

    def accelerations(self, pushes: Iterable[Push]) -> tuple[Expression, Expression, Expression]:
        """Return u', q', W' under these pushes and the slope; (x, y) is the centre of mass.

        I_c W' = F_W - x F_q + y F_u, u' = F_u / m - g_u + q W + x W2 + y W',
        q' = F_q / m + g_q - u W + y W2 - x W'.
        """
        given = tuple(pushes)
        ahead, left, around = (
            sum(getattr(push, way) for push in given) for way in ("ahead", "left", "moment")
        )
        turning = shared((around - self._ahead * left + self._left * ahead) / self._central)
        squared = shared(self.yaw_rate**2)
        forwards = (
            ahead / self.mass
            - self.downhill * self.uphill_ahead
            + self.drift * self.yaw_rate
            + self._ahead * squared
            + self._left * turning
        )
        sideways = (
            left / self.mass
            + self.downhill * self.uphill_right
            - self.speed * self.yaw_rate
            + self._left * squared
            - self._ahead * turning
        )
        return (
            self._sliding(forwards, self.speed),
            self._sliding(sideways, self.drift),
            self._sliding(turning, self.yaw_rate),
        )

    def energy(self) -> Expression:
        """Return the energy of motion and height in J, for a slope and a payload that stay."""
        kinetic = self.mass * (self.speed**2 + self.drift**2) + self.inertia * self.yaw_rate**2
        kinetic += 2 * (self.offset_mass * self.drift - self._side_mass * self.speed) * self.yaw_rate
        uphill = symbol("x") * sp.cos(P["slope_heading"]) + symbol("y") * sp.sin(P["slope_heading"])
        climb = (
            self.mass * uphill + self.offset_mass * self.uphill_ahead - self._side_mass * self.uphill_right
        )
        return HALF * kinetic + self.downhill * climb

    def _sliding(self, rate: Expression, speed: Expression) -> Expression:
        """Return the rate on wheels, and that of a robot that lies on the floor."""
        return (1 - self._lies) * rate - self._lies * speed / SLIDES_ON
