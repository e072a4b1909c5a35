"""A plant model: typed rows from which code, description and archive are written.

A model folder gives parameters and equations; it knows nothing about C, XML or FMI.
"""

import warnings
from dataclasses import dataclass
from typing import Any, TypeAlias

Expression: TypeAlias = Any
"""A SymPy expression; SymPy carries no type information."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value that a user may set before the run; `source` is the origin of the default.

    A `tunable` one may change in the run: load, friction, slope, supply. Outside `least` to `most` it is
    refused; where `least` is not given, the unit decides: no mass is below 0.
    """

    name: str
    start: float
    unit: str
    description: str
    source: str
    least: float | None = None
    most: float | None = None
    tunable: bool = False


@dataclass(frozen=True, slots=True)
class Input:
    """A value that is held during a communication step; a `switch` is 0 open or 1 closed."""

    name: str
    unit: str
    description: str
    nominal: float = 1.0
    switch: bool = False


@dataclass(frozen=True, slots=True)
class StateVariable:
    """One first-order equation; the unit is that of the state.

    `start` is 0, which a user may change before the run, or an expression in parameters and such states.
    """

    name: str
    unit: str
    start: Expression
    rate: Expression


@dataclass(frozen=True, slots=True)
class Output:
    """A value that can be read; `local` ones are for people and tests, not for the regulators.

    A `switch` is 0 open or 1 closed, and changes where an event is. `least` is what it is never below.
    """

    name: str
    unit: str
    description: str
    expression: Expression
    nominal: float = 1.0
    local: bool = False
    switch: bool = False
    least: float | None = None


@dataclass(frozen=True, slots=True)
class Event:
    """A value that passes 0 where something meets a stop, a flank or a switch; solvers stop there."""

    name: str
    unit: str
    description: str
    expression: Expression


@dataclass(frozen=True, slots=True)
class Model:
    """Equations and tables of one plant. Symbols carry the names of parameters, inputs and states."""

    name: str
    description: str
    parameters: tuple[Parameter, ...]
    inputs: tuple[Input, ...]
    states: tuple[StateVariable, ...]
    outputs: tuple[Output, ...]
    inner_step: float
    """Longest step of the integrator in seconds."""
    events: tuple[Event, ...] = ()


def __getattr__(name: str) -> Any:
    """Return a class under its name of the release before, with a warning."""
    if name != "State":
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    text = "'State' is called 'StateVariable' now; the old name works in this release only"
    warnings.warn(f"{__name__}: {text}", FutureWarning, stacklevel=2)
    return StateVariable
