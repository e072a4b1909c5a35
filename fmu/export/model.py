"""What a plant model consists of: typed rows that code, description and archive are written from.

A model folder gives parameters and equations; it knows nothing about C, XML or FMI.
"""

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
