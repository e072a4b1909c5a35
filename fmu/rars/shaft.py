"""One motor's shaft: winding, rotor, and the dry friction that every shaft has."""

import sympy as sp

from fmu.export.model import Expression, State
from fmu.rars.parameters import PARAMETERS

P = {row.name: sp.Symbol(row.name, real=True) for row in PARAMETERS}
"""Symbols of the parameters by name."""

HALF = sp.Rational(1, 2)


def symbol(name: str) -> Expression:
    """Return the symbol of an input or state."""
    return sp.Symbol(name, real=True)


class Shaft:
    """A brushed DC motor; the part that it drives closes its equation of motion.

    Dry friction is a bristle (Dahl): state `friction` in -1..1, torque = level x friction. At rest it holds
    like a spring, in motion it is Coulomb's law; it takes out energy and never adds any.
    """

    def __init__(self, axis: str) -> None:
        self.axis = axis
        self.voltage = symbol(f"voltage_{axis}")
        self.current = symbol(f"current_{axis}")
        self.angle = symbol(f"angle_{axis}")
        self.speed = symbol(f"speed_{axis}")
        self.friction = symbol(f"friction_{axis}")
        self.gear = P[f"gear_{axis}"]
        self.inertia = P[f"rotor_inertia_{axis}"]
        self.coulomb = P[f"coulomb_{axis}"]
        self.free_torque = P[f"torque_constant_{axis}"] * self.current - P[f"viscous_{axis}"] * self.speed

    def states(self, acceleration: Expression, friction_start: Expression = sp.S.Zero) -> tuple[State, ...]:
        """Return winding, shaft and bristle; `acceleration` in rad/s2 at the motor."""
        axis = self.axis
        winding = (
            self.voltage - P[f"resistance_{axis}"] * self.current - P[f"torque_constant_{axis}"] * self.speed
        )
        bristle = (self.speed - sp.Abs(self.speed) * self.friction) / P["presliding"]
        return (
            State(f"current_{axis}", "A", sp.S.Zero, winding / P[f"inductance_{axis}"]),
            State(f"angle_{axis}", "rad", sp.S.Zero, self.speed),
            State(f"speed_{axis}", "rad/s", sp.S.Zero, acceleration),
            State(f"friction_{axis}", "1", friction_start, bristle),
        )

    def energy(self) -> Expression:
        """Return the energy of winding, rotor and bristle in J."""
        winding = P[f"inductance_{self.axis}"] * self.current**2
        bristle = self.coulomb * P["presliding"] * self.friction**2
        return HALF * (winding + self.inertia * self.speed**2 + bristle)
