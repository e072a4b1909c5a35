"""A brushed DC motor's shaft: winding, rotor, and the dry friction that every shaft has."""

from collections.abc import Mapping

import sympy as sp

from fmu.export.model import Expression, Output, State
from fmu.parts.symbols import HALF, inner, symbol


class Shaft:
    """A motor's shaft; the part that it drives closes its equation of motion.

    Dry friction is a bristle (Dahl): state `friction` in -1..1, torque = level x friction. At rest it holds
    like a spring, in motion it is Coulomb's law; it takes out energy and never adds any.
    """

    def __init__(self, axis: str, parameters: Mapping[str, Expression]) -> None:
        self.axis = axis
        self._p = parameters
        self.voltage = symbol(f"voltage_{axis}")
        self.current = symbol(f"current_{axis}")
        self.angle = symbol(f"angle_{axis}")
        self.speed = symbol(f"speed_{axis}")
        self.friction = symbol(f"friction_{axis}")
        self.gear = parameters[f"gear_{axis}"]
        self.inertia = parameters[f"rotor_inertia_{axis}"]
        self.coulomb = parameters[f"coulomb_{axis}"]
        damping = parameters[f"viscous_{axis}"] * self.speed
        self.free_torque = parameters[f"torque_constant_{axis}"] * self.current - damping
        self.torque = self.free_torque - self.coulomb * self.friction

    def states(self, acceleration: Expression, friction_start: Expression = sp.S.Zero) -> tuple[State, ...]:
        """Return winding, shaft and bristle; `acceleration` in rad/s2 at the motor."""
        axis, p = self.axis, self._p
        winding = (
            self.voltage - p[f"resistance_{axis}"] * self.current - p[f"torque_constant_{axis}"] * self.speed
        )
        return (
            State(f"current_{axis}", "A", sp.S.Zero, winding / p[f"inductance_{axis}"]),
            State(f"angle_{axis}", "rad", sp.S.Zero, self.speed),
            State(f"speed_{axis}", "rad/s", sp.S.Zero, acceleration),
            State(
                f"friction_{axis}", "1", friction_start, bristle(self.speed, self.friction, p["presliding"])
            ),
        )

    def energy(self) -> Expression:
        """Return the energy of winding, rotor and bristle in J."""
        winding = self._p[f"inductance_{self.axis}"] * self.current**2
        dry = self.coulomb * self._p["presliding"] * self.friction**2
        return HALF * (winding + self.inertia * self.speed**2 + dry)

    def outputs(self) -> tuple[Output, ...]:
        """Return what a drive measures."""
        axis = self.axis
        return (
            Output(f"current_{axis}", "A", f"motor current, {axis}", self.current, 1.0),
            Output(f"angle_{axis}", "rad", f"motor shaft's angle, {axis}", self.angle, 1.0),
            Output(f"speed_{axis}", "rad/s", f"motor shaft's speed, {axis}", self.speed, 100.0),
        )

    def dry_friction(self) -> Output:
        """Return the bristle as a reading."""
        return inner(f"friction_{self.axis}", "1", f"dry friction over its level, {self.axis}", self.friction)


def bristle(speed: Expression, state: Expression, presliding: Expression) -> Expression:
    """Return the rate of a bristle in -1..1 (Dahl): it follows the motion over `presliding`, then slides."""
    return (speed - sp.Abs(speed) * state) / presliding
