"""A brushed DC motor's shaft: winding, rotor, and the dry friction that every shaft has."""

from collections.abc import Mapping
from typing import Final

import sympy as sp

from fmu.export.functions import clamped, positive_part, size
from fmu.export.model import Expression, Output, StateVariable
from fmu.parts.symbols import HALF, inner, symbol

STICTION: Final = sp.Float(1.25)
"""Ratio of static to sliding friction: assumed, brushes and gear grease have 1.1 to 1.5."""
STICKING_RATE: Final = sp.Float(4.0)
"""1/s: friction falls to Coulomb's law up to the speed of so many `presliding` a second (assumed)."""
HELD: Final = sp.Float(0.8)
LOOSE: Final = sp.Float(0.95)
"""Shares of what holds: all spring up to the first, all sliding from the second (assumed)."""


class Shaft:
    """A motor's shaft; the part that it drives closes its equation of motion.

    Dry friction is a bristle: torque = level x its state `friction`. At rest it holds like a spring, up to
    `STICTION`; in motion it is Coulomb's law, -1 or 1. It takes out energy and never adds any.
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

    def states(
        self, acceleration: Expression, friction_start: Expression = sp.S.Zero
    ) -> tuple[StateVariable, ...]:
        """Return winding, shaft and bristle; `acceleration` in rad/s2 at the motor."""
        axis, p = self.axis, self._p
        winding = (
            self.voltage - p[f"resistance_{axis}"] * self.current - p[f"torque_constant_{axis}"] * self.speed
        )
        return (
            StateVariable(f"current_{axis}", "A", sp.S.Zero, winding / p[f"inductance_{axis}"]),
            StateVariable(f"angle_{axis}", "rad", sp.S.Zero, self.speed),
            StateVariable(f"speed_{axis}", "rad/s", sp.S.Zero, acceleration),
            StateVariable(
                f"friction_{axis}",
                "1",
                friction_start,
                bristle(self.speed, self.friction, p["presliding"]),
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
    """Return the rate of a bristle: it follows the motion over `presliding`, then slides at +1 or -1.

    Dahl's bristle with an elastic part (Dupont et al., IEEE Trans. Automatic Control 47, 2002): below `HELD`
    of what holds at rest it is a spring, so that a shaft that is shaken at rest does not creep, and it
    lets go of its bend as a spring. It takes out energy, level x s^2 times the slid way, and never adds any.
    """
    per_angle = 1 / presliding
    fast = size(speed)
    # Stribeck: the bristle bears 1.25 times as much at rest, down to Coulomb's law at higher speed.
    lean = state * (1 - (1 - 1 / STICTION) * positive_part(1 - fast * per_angle / STICKING_RATE) ** 2)
    held = clamped(lean, HELD)
    # 0 while it is a spring, 1 where it slides.
    share = clamped(size(lean - held) / (LOOSE - HELD), sp.S.One)
    # Without a kink, for solvers that choose their steps; this half of it and twice the way onward.
    sliding = share**2 * (sp.Rational(3, 2) - share)
    onward = fast + held / HELD * speed
    return (speed - sliding * lean * onward) * per_angle
