"""One division where an expression is divided by several powers of one value.

A division takes as long as five multiplications and cannot be overlapped with the next one, so 1 / x, 1 / x^2
and 1 / x^3 become powers of one reciprocal.
"""

from collections.abc import Sequence
from typing import TypeAlias

import sympy as sp

from fmu.export.model import Expression

Lines: TypeAlias = tuple[tuple[Expression, Expression], ...]
"""Temporaries in order: symbol and value."""


def with_reciprocals(shared: Lines, results: Sequence[Expression]) -> tuple[Lines, list[Expression]]:
    """Return a block's temporaries and results with the reciprocals of what is divided by more than once."""
    powers: dict[Expression, set[Expression]] = {}
    for expression in (*(value for _, value in shared), *results):
        for power in expression.atoms(sp.Pow):
            if power.base.is_Symbol and power.exp.is_Integer and power.exp.is_negative:
                powers.setdefault(power.base, set()).add(power)
    # By name: a set's order is not the same in each process.
    often = sorted((base for base, found in powers.items() if len(found) > 1), key=lambda base: base.name)
    reciprocals = {base: sp.Symbol(f"r{n}", real=True) for n, base in enumerate(often)}
    products = {power: reciprocals[base] ** -power.exp for base in often for power in powers[base]}
    defined = {symbol for symbol, _ in shared}
    lines = [(reciprocals[base], 1 / base) for base in often if base not in defined]
    for symbol, value in shared:
        lines.append((symbol, value.xreplace(products)))
        if symbol in reciprocals:
            lines.append((reciprocals[symbol], 1 / symbol))
    return tuple(lines), [result.xreplace(products) for result in results]
