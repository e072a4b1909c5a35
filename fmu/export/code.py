"""Equations to C: constants hoisted, common subexpressions shared, no function but sqrt and our own.

Refuses to know what the equations mean.
"""

import math
from collections.abc import Mapping, Sequence

import sympy as sp

from fmu.export.model import Expression, Model

_FUNCTIONS: Mapping[str, str] = {
    "sin": "fb_sine",
    "cos": "fb_cosine",
    "atan": "fb_arc_tangent",
    "Abs": "fabs",
    "positive_part": "fb_positive_part",
    "clamped": "fb_clamped",
}
_POWERS: Mapping[int, str] = {2: "fb_square", 3: "fb_cube", 4: "fb_fourth"}


class UnsupportedError(Exception):
    """An expression that this exporter has no deterministic C for."""


def c_text(expression: Expression) -> str:
    """Return an expression as C, fully parenthesised, so that every compiler rounds in the same places."""
    if expression.is_Symbol:
        return str(expression.name)
    if expression.is_number and expression.is_Atom:
        return _number(expression)
    if expression.is_Add:
        return _sum(expression)
    if expression.is_Mul:
        return _product(expression)
    if expression.is_Pow:
        return _power(expression.base, expression.exp)
    name = type(expression).__name__
    if name in _FUNCTIONS:
        return f"{_FUNCTIONS[name]}({', '.join(c_text(part) for part in expression.args)})"
    raise UnsupportedError(f"no C for {name} in {expression}")


def _number(number: Expression) -> str:
    value = math.pi if number is sp.pi else float(number)
    return repr(value)


def _sum(expression: Expression) -> str:
    text = ""
    for term in expression.args:
        negative = term.could_extract_minus_sign()
        part = c_text(-term if negative else term)
        text += (" - " if negative else " + ") + part if text else ("-" if negative else "") + part
    return f"({text})"


def _product(expression: Expression) -> str:
    over: list[str] = []
    under: list[str] = []
    sign = ""
    for factor in expression.args:
        if factor is sp.S.NegativeOne:
            sign = "-"
        elif factor.is_Pow and factor.exp.is_negative:
            under.append(_power(factor.base, -factor.exp))
        else:
            over.append(c_text(factor))
    top = " * ".join(over) or "1.0"
    bottom = f" / {under[0]}" if len(under) == 1 else f" / ({' * '.join(under)})" if under else ""
    return f"({sign}{top}{bottom})"


def _power(base: Expression, exponent: Expression) -> str:
    if exponent.is_negative:
        return f"(1.0 / {_power(base, -exponent)})"
    text = c_text(base)
    if exponent == 1:
        return text
    if exponent == sp.Rational(1, 2):
        return f"sqrt({text})"
    if exponent.is_Integer and int(exponent) in _POWERS:
        return f"{_POWERS[int(exponent)]}({text})"
    if exponent.is_Rational and exponent.q == 2:  # noqa: PLR2004 - a half
        return f"(sqrt({text}) * {_power(base, exponent - sp.Rational(1, 2))})"
    raise UnsupportedError(f"no C for the power {exponent} of {base}")


class _Hoister:
    """Replaces what depends on parameters alone by constants that are computed once."""

    def __init__(self, parameters: frozenset[Expression]) -> None:
        self._parameters = parameters
        self.constants: dict[Expression, Expression] = {}

    def hoist(self, expression: Expression) -> Expression:
        """Return the expression with its constant parts named."""
        free = expression.free_symbols
        if not free or (expression.is_Symbol):
            return expression
        if free <= self._parameters:
            return self._named(expression)
        if expression.is_Add or expression.is_Mul:
            fixed = [part for part in expression.args if part.free_symbols <= self._parameters]
            moving = [self.hoist(part) for part in expression.args if part not in fixed]
            group = expression.func(*fixed)
            if group.free_symbols:
                group = self._named(group)
            return expression.func(group, *moving)
        return expression.func(*(self.hoist(part) for part in expression.args))

    def _named(self, expression: Expression) -> Expression:
        if expression.is_Symbol:
            return expression
        if expression not in self.constants:
            self.constants[expression] = sp.Symbol(f"k{len(self.constants)}", real=True)
        return self.constants[expression]


def generate(model: Model, token: str) -> dict[str, str]:
    """Return model.h (sizes) and model.c (tables, constants, starts, rates, readings)."""
    hoister = _Hoister(frozenset(_real(row.name) for row in model.parameters))
    rates = [hoister.hoist(state.rate) for state in model.states]
    readings = [hoister.hoist(output.expression) for output in model.outputs]
    starts = [hoister.hoist(sp.sympify(state.start)) for state in model.states]
    constants = list(hoister.constants)
    names = _places("p", [row.name for row in model.parameters]) | _places(
        "u", [row.name for row in model.inputs]
    )
    names |= _places("s", [state.name for state in model.states])
    names |= _places("k", [symbol.name for symbol in hoister.constants.values()])
    # The shell's reset writes zeros; derived starts follow the parameters.
    derived = [i for i, start in enumerate(starts) if start.free_symbols]
    if any(starts[i] != 0 for i in range(len(starts)) if i not in derived):
        raise UnsupportedError("a state's start must be 0 or an expression in parameters and states")
    variables = ["time", *(row.name for row in model.inputs), *(row.name for row in model.parameters)]
    variables += [output.name for output in model.outputs]
    sizes = {
        "FB_INPUTS": len(model.inputs),
        "FB_PARAMETERS": len(model.parameters),
        "FB_READINGS": len(model.outputs),
        "FB_STATES": len(model.states),
        "FB_CONSTANTS": max(1, len(constants)),
        "FB_INNER_STEP": repr(model.inner_step),
        "FB_TOKEN": f'"{token}"',
    }
    moment = "const double *restrict s, const double *restrict u, const double *restrict p"
    moment += ", const double *restrict k"
    parts = (
        f"/* {model.description}. Written from the equations; do not edit. */\n",
        '#include "core.h"\n#include "elementary.h"\n',
        _table("char *const", "fb_names[FB_VARIABLES]", [f'"{name}"' for name in variables]),
        _table(
            "double", "fb_parameter_starts[FB_PARAMETERS]", [repr(float(r.start)) for r in model.parameters]
        ),
        _table("char *const", "fb_state_names[FB_STATES]", [f'"{state.name}"' for state in model.states]),
        _table("int", "fb_state_of_reading[FB_READINGS]", [str(i) for i in settable_states(model)]),
        _function("fb_constants(const double *restrict p, double *restrict k)", "k", constants, names),
        _function(
            "fb_starts(const double *restrict p, const double *restrict k, double *restrict s)",
            "s",
            [starts[i] for i in derived],
            names,
            derived,
        ),
        _function(f"fb_rates({moment}, double *restrict rate)", "rate", rates, names),
        _function(f"fb_readings({moment}, double *restrict reading)", "reading", readings, names),
    )
    return {
        "model.h": "".join(f"#define {name} {value}\n" for name, value in sizes.items()),
        "model.c": "\n".join(parts),
    }


def settable_states(model: Model) -> list[int]:
    """Return for each output the state that its start value sets, -1 where it is computed."""
    position = {state.name: i for i, state in enumerate(model.states) if sp.sympify(state.start).is_number}
    return [
        position.get(output.expression.name, -1) if output.expression.is_Symbol else -1
        for output in model.outputs
    ]


def _places(array: str, names: Sequence[str]) -> dict[Expression, Expression]:
    return {_real(name): _real(f"{array}[{i}]") for i, name in enumerate(names)}


def _real(name: str) -> Expression:
    return sp.Symbol(name, real=True)


def _table(kind: str, name: str, entries: Sequence[str]) -> str:
    rows = "".join(f"  {entry},\n" for entry in entries)
    return f"const {kind} {name} = {{\n{rows}}};\n"


def _function(
    signature: str,
    target: str,
    expressions: Sequence[Expression],
    names: Mapping[Expression, Expression],
    places: Sequence[int] | None = None,
) -> str:
    shared, results = sp.cse([e.xreplace(names) for e in expressions], sp.numbered_symbols("t", real=True))
    lines = [f"  (void){argument};\n" for argument in "supk" if f"restrict {argument}" in signature]
    lines += [f"  const double {symbol} = {c_text(value)};\n" for symbol, value in shared]
    for place, value in zip(places or range(len(results)), results, strict=True):
        lines.append(f"  {target}[{place}] = {c_text(value)};\n")
    return f"void {signature} {{\n{''.join(lines)}}}\n"
