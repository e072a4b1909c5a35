"""What a plant model consists of: typed rows that code, description and archive are written from.

A model folder gives parameters and equations; it knows nothing about C, XML or FMI.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

Expression: TypeAlias = Any
"""A SymPy expression; SymPy carries no type information."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A fixed value that a user may set before the run; `source` says where the default comes from."""

    name: str
    start: float
    unit: str
    description: str
    source: str


@dataclass(frozen=True, slots=True)
class Input:
    """A value that is held during a communication step."""

    name: str
    unit: str
    description: str
    nominal: float = 1.0


@dataclass(frozen=True, slots=True)
class State:
    """One first-order equation; the unit is that of the state.

    `start` is 0, which a user may change before the run, or an expression in parameters and such states.
    """

    name: str
    unit: str
    start: Expression
    rate: Expression


@dataclass(frozen=True, slots=True)
class Output:
    """A value that can be read; `local` ones are for people and tests, not for the regulators."""

    name: str
    unit: str
    description: str
    expression: Expression
    nominal: float = 1.0
    local: bool = False


@dataclass(frozen=True, slots=True)
class Model:
    """Equations and tables of one plant. Symbols carry the names of parameters, inputs and states."""

    name: str
    description: str
    parameters: tuple[Parameter, ...]
    inputs: tuple[Input, ...]
    states: tuple[State, ...]
    outputs: tuple[Output, ...]
    inner_step: float
    """Longest step of the integrator in seconds."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit by its SI exponents (FMI 2.0.4 section 2.2.2, FMI 3.0.2 section 2.4.3)."""

    kg: int = 0
    m: int = 0
    s: int = 0
    A: int = 0
    rad: int = 0

    def exponents(self) -> dict[str, int]:
        """Return the exponents that are not zero."""
        every = {"kg": self.kg, "m": self.m, "s": self.s, "A": self.A, "rad": self.rad}
        return {base: power for base, power in every.items() if power}


UNITS: Mapping[str, Unit] = {
    "1": Unit(),
    "s": Unit(s=1),
    "m": Unit(m=1),
    "m/s": Unit(m=1, s=-1),
    "m/s2": Unit(m=1, s=-2),
    "s/m": Unit(m=-1, s=1),
    "rad": Unit(rad=1),
    "rad/s": Unit(rad=1, s=-1),
    "kg": Unit(kg=1),
    "kg.m2": Unit(kg=1, m=2),
    "N": Unit(kg=1, m=1, s=-2),
    "N/m": Unit(kg=1, s=-2),
    "N.m": Unit(kg=1, m=2, s=-2),
    "N.m.s/rad": Unit(kg=1, m=2, s=-1, rad=-1),
    "N.m/A": Unit(kg=1, m=2, s=-2, A=-1),
    "J": Unit(kg=1, m=2, s=-2),
    "A": Unit(A=1),
    "V": Unit(kg=1, m=2, s=-3, A=-1),
    "Ohm": Unit(kg=1, m=2, s=-3, A=-2),
    "H": Unit(kg=1, m=2, s=-2, A=-2),
}
"""Units that models may use."""
