"""A magnet's hold at one contact: how far it is pulled off, when it lets go, and when it slides.

Forces are those of balance (no inertia). The gap is a state: it stays 0 while the magnet holds more than what
pulls at it, and beyond the magnet's reach it is lost for good.
"""

from dataclasses import dataclass

import sympy as sp

from fmu.climber.contact import Contact
from fmu.climber.vectors import Vector, dot, kept, plus
from fmu.export.functions import larger, named, passed, positive_part
from fmu.export.model import Expression, Output, StateVariable
from fmu.parts.symbols import inner, symbol

PEELING = sp.Float(0.02)
"""m/s for each N that pulls more than the magnet holds (assumed): it lets go within some 10 ms."""
CLOSING = sp.Float(500.0)
"""1/s, how fast a gap closes again (assumed)."""
TRACE = sp.Float(1e-12)
"""N2, so that nothing is divided by zero where no force is."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """A magnet's reach in m, friction between wheel and wall, N beyond it for each m/s."""

    reach: Expression
    friction: Expression
    damping: Expression


class Hold:
    """One contact under the force that the surface must give it."""

    def __init__(
        self, name: str, contact: Contact, force: Vector, magnet: Expression, around: Surroundings
    ) -> None:
        self.name = name
        self._around = around
        self.gap = symbol(f"gap_{name}")
        self.pull = named(-dot(contact.normal, force))
        """Part of the force that pulls the wheel off, in N."""
        self.magnet = magnet * positive_part(1 - self.gap / around.reach)
        self.load = positive_part(self.magnet - self.pull)
        """Force that presses the wheel on, in N."""
        across = kept(plus((1, force), (self.pull, contact.normal)))
        self.across = named(sp.sqrt(dot(across, across) + TRACE))
        """The force along the surface in N."""
        # The excess over friction lets the wheel slide, by its damping: no state for sticking is needed.
        self.excess = positive_part(self.across - around.friction * self.load)
        self.slide = kept(plus((-self.excess / (around.damping * self.across), across)))
        """The velocity of the wheel's material in m/s: against the force, as fast as it is too large."""

    def state(self) -> StateVariable:
        """Return the gap; what is lost stays lost."""
        opening = PEELING * (self.pull - self.magnet)
        # Beyond the reach the rate is 0: a magnet that has let go does not catch again.
        held = 1 - passed(self.gap - self._around.reach)
        return StateVariable(f"gap_{self.name}", "m", sp.S.Zero, held * larger(opening, -CLOSING * self.gap))

    def outputs(self) -> tuple[Output, ...]:
        """Return the gap, and for people and tests what holds."""
        name = self.name
        return (
            Output(f"gap_{name}", "m", f"gap under the magnet, {name}", self.gap, 1e-3),
            inner(f"load_{name}", "N", f"what presses the wheel on, {name}", self.load, 10.0),
            inner(f"pull_{name}", "N", f"force of balance that pulls it off, {name}", self.pull, 10.0),
            inner(f"across_{name}", "N", f"force along the surface, {name}", self.across, 10.0),
            inner(
                f"slide_{name}",
                "m/s",
                f"speed at which the wheel slides, {name}",
                self.excess / self._around.damping,
                0.1,
            ),
        )
