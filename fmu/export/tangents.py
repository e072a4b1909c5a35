"""Forward-mode derivatives of a block: beside every value its tangent, exact, one line for one line.

At a kink (|x|, positive_part, clamped, larger) the tangent is that of one side.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import sympy as sp

from fmu.export.blocks import Block, UnsupportedError, real
from fmu.export.functions import passed, reciprocal
from fmu.export.model import Expression

sign: Final = sp.Function("sign_of", real=True)
inside: Final = sp.Function("inside", real=True)
outside: Final = sp.Function("outside", real=True)
root_slope: Final = sp.Function("root_slope", real=True)
"""Slopes of |x|, positive_part(x), clamped(x, b) by x and by b, and of the square root (0 at 0)."""


@dataclass(frozen=True, slots=True)
class TangentBlock:
    """A block's temporaries and their tangents in order, as far as they are needed, and the results."""

    block: Block
    shared: tuple[tuple[Expression, Expression], ...]
    results: tuple[tuple[int, Expression], ...]


def tangents(block: Block) -> TangentBlock:
    """Return the block that computes `block`'s tangent from those of its arrays (d before their letter)."""
    slopes: dict[Expression, Expression] = {}
    lines: list[tuple[Expression, Expression]] = []
    for symbol, value in block.shared:
        tangent = _tangent(value, slopes)
        slopes[symbol] = real(f"d{symbol.name}") if tangent != 0 else sp.S.Zero
        lines += [(symbol, value), (slopes[symbol], tangent)]
    results = tuple((place, _tangent(value, slopes)) for place, value in block.results)
    needed: set[Expression] = set().union(*(slope.free_symbols for _, slope in results))
    kept = []
    # Backwards: a line counts only if a later one, or a result, needs it.
    for symbol, value in reversed(lines):
        if symbol in needed:
            needed |= value.free_symbols
            kept.append((symbol, value))
    return TangentBlock(block, tuple(reversed(kept)), results)


def _tangent(expression: Expression, slopes: Mapping[Expression, Expression]) -> Expression:
    if expression.is_Symbol:
        return slopes.get(expression, real(f"d{expression.name}"))
    if not expression.free_symbols:
        return sp.S.Zero
    if expression.is_Add:
        return sp.Add(*(_tangent(part, slopes) for part in expression.args))
    if expression.is_Mul:
        return _of_product(expression, slopes)
    if expression.is_Pow:
        return _of_power(expression.base, expression.exp) * _tangent(expression.base, slopes)
    return sp.Add(
        *(
            slope * _tangent(part, slopes)
            for slope, part in zip(_of_function(expression), expression.args, strict=True)
        )
    )


def _of_product(expression: Expression, slopes: Mapping[Expression, Expression]) -> Expression:
    terms = []
    for i, factor in enumerate(expression.args):
        slope = _tangent(factor, slopes)
        if slope != 0:
            others = (*expression.args[:i], *expression.args[i + 1 :])
            terms.append(sp.Mul(*others, slope))
    return sp.Add(*terms)


def _of_power(base: Expression, exponent: Expression) -> Expression:
    if not exponent.is_number:
        raise UnsupportedError(f"no derivative for the power {exponent} of {base}")
    if exponent == sp.Rational(1, 2):
        return root_slope(base)
    return exponent * base ** (exponent - 1)


def _of_function(expression: Expression) -> tuple[Expression, ...]:
    name = type(expression).__name__
    if name not in _SLOPES:
        raise UnsupportedError(f"no derivative for {name} in {expression}")
    return _SLOPES[name](*expression.args)


_SLOPES: Final[Mapping[str, Callable[..., tuple[Expression, ...]]]] = {
    "sin": lambda x: (sp.cos(x),),
    "cos": lambda x: (-sp.sin(x),),
    "atan": lambda x: (1 / (1 + x**2),),
    "angle": lambda y, x: (x / (x**2 + y**2), -y / (x**2 + y**2)),
    "Abs": lambda x: (sign(x),),
    "size": lambda x: (sign(x),),
    "positive_part": lambda x: (passed(x),),
    "clamped": lambda x, bound: (inside(x, bound), outside(x, bound)),
    "shared": lambda _: (sp.S.One,),
    "named": lambda _: (sp.S.One,),
    "larger": lambda x, y: (passed(x - y), 1 - passed(x - y)),
    "step_at": lambda _: (sp.S.Zero,),
    "reciprocal": lambda x: (-(reciprocal(x) ** 2),),
}
"""Slopes of a function by each of its arguments."""
