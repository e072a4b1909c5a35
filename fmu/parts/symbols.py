"""Symbols for equations: parameters, inputs and states go by their names."""

from collections.abc import Iterable, Mapping
from typing import Final

import sympy as sp

from fmu.export.model import Expression, Output, Parameter

HALF: Final = sp.Rational(1, 2)


def symbol(name: str) -> Expression:
    """Return the symbol of a parameter, input or state."""
    return sp.Symbol(name, real=True)


def symbols(rows: Iterable[Parameter]) -> Mapping[str, Expression]:
    """Return the symbols of parameters by name."""
    return {row.name: symbol(row.name) for row in rows}


def inner(name: str, unit: str, description: str, expression: Expression, nominal: float = 1.0) -> Output:
    """Return a reading for people and tests."""
    return Output(name, unit, description, expression, nominal, local=True)
