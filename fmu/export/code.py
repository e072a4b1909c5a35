"""Blocks to C: no function but sqrt and our own. Not known here: what the equations mean."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import sympy as sp

from fmu.export.blocks import Block, ModelCode, UnsupportedError
from fmu.export.model import Expression
from fmu.export.tangents import TangentBlock, tangents
from fmu.export.variables import variables

__all__ = ["UnsupportedError", "body", "c_text", "generate"]

_FUNCTIONS: Final[Mapping[str, str]] = {
    "sin": "fb_sine",
    "cos": "fb_cosine",
    "atan": "fb_arc_tangent",
    "angle": "fb_angle",
    "Abs": "fabs",
    "size": "fabs",
    "positive_part": "fb_positive_part",
    "clamped": "fb_clamped",
    "larger": "fb_larger",
    "reciprocal": "fb_reciprocal",
    "shared": "",
    "named": "",
    "sign_of": "fb_sign",
    "step_at": "fb_step_at",
    "inside": "fb_inside",
    "outside": "fb_outside",
    "root_slope": "fb_root_slope",
}
_POWERS: Final[Mapping[int, str]] = {2: "fb_square", 3: "fb_cube", 4: "fb_fourth"}
_KINDS: Final[Mapping[str, str]] = {
    "continuous": "FB_FREE",
    "discrete": "FB_SWITCH",
    "fixed": "FB_FIXED",
    "tunable": "FB_TUNABLE",
}
"""Variability of time, inputs and parameters, as c/core.h knows it."""
_HIGHEST_POWER: Final = 5
"""Highest power of a tangent: the slope of 1 / x^4."""


def c_text(expression: Expression) -> str:
    """Return an expression as C, fully parenthesised, so that every compiler rounds in the same places.

    It is Python, too, with the same meaning.
    """
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
        return _call(_FUNCTIONS[name], expression.args)
    raise UnsupportedError(f"no C for {name} in {expression}")


def _number(number: Expression) -> str:
    # repr() below is the shortest text that reads back as the same double.
    value = math.pi if number is sp.pi else float(number)
    return repr(value)


def _call(name: str, arguments: Sequence[Expression]) -> str:
    return f"{name}({', '.join(map(c_text, arguments))})"


def _sum(expression: Expression) -> str:
    text = ""
    for term in expression.args:
        # A subtraction in place of a sum with a negated term: the same bits, and readable.
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
    # One division by the product of all divisors: a division costs as much as five multiplications.
    top = " * ".join(over) or "1.0"
    bottom = f" / {under[0]}" if len(under) == 1 else f" / ({' * '.join(under)})" if under else ""
    return f"({sign}{top}{bottom})"


def _power(base: Expression, exponent: Expression) -> str:
    if exponent.is_negative:
        return f"(1.0 / {_power(base, -exponent)})"
    if exponent == 1:
        return c_text(base)
    if exponent == sp.Rational(1, 2):
        return _call("sqrt", (base,))
    if exponent.is_Integer and int(exponent) in _POWERS:
        return _call(_POWERS[int(exponent)], (base,))
    if exponent == _HIGHEST_POWER:
        return f"({_call('fb_fourth', (base,))} * {c_text(base)})"
    # sqrt times a whole power: pow() gives other bits in other C libraries, and sqrt is exact in all of them.
    if exponent.is_Rational and exponent.q == 2:  # noqa: PLR2004 - a half
        rest = _power(base, exponent - sp.Rational(1, 2))
        return f"({_call('sqrt', (base,))} * {rest})"
    raise UnsupportedError(f"no C for the power {exponent} of {base}")


def generate(program: ModelCode, token: str, core: str) -> dict[str, str]:
    """Return model.h (sizes and names), model.c (tables and blocks), tangents.c.

    What `core`, the text of core.h, declares gets the model's name in front, so that two models may link.
    """
    model = program.model
    constants = next(len(block.results) for block in program.blocks if block.name == "constants")
    sizes = {
        "FB_INPUTS": len(model.inputs),
        "FB_PARAMETERS": len(model.parameters),
        "FB_PROMPT": program.prompt,
        "FB_OUTPUTS": len(program.outputs),
        "FB_LOCALS": len(program.locals),
        "FB_STATES": len(model.states),
        "FB_CONSTANTS": max(1, constants),
        "FB_SWITCH_INPUTS": sum(row.switch for row in model.inputs),
        "FB_SWITCHES": len(program.switch_readings),
        "FB_INDICATORS": len(model.events),
        "FB_INNER_STEP": repr(model.inner_step),
        "FB_TOKEN": f'"{token}"',
    }
    # In the order of the text, each once: the generated header must be the same bytes each time.
    outside = dict.fromkeys(re.findall(r"\bfb_\w+(?=[\[(])", core))
    sizes |= {name: f"{model.name}_{name}" for name in outside}
    rows = variables(program)
    settable = rows[: 1 + len(model.inputs) + len(model.parameters)]
    nominals = {row.name: row.nominal for row in rows}
    shown = {real: row.name for row, real in zip(program.readings, program.states_of_readings, strict=True)}
    head = f"/* {model.description}. Written from the equations; do not edit. */\n"
    include = '#include <float.h>\n\n#include "core.h"\n#include "elementary.h"\n'
    parts = (
        head,
        include,
        _table("char *const", "fb_names[FB_VARIABLES]", [f'"{row.name}"' for row in rows]),
        _table("fb_kind", "fb_kinds[FB_FIRST_READING]", [_KINDS[row.variability] for row in settable]),
        _table("double", "fb_least[FB_FIRST_READING]", [_bound(row.least, "-DBL_MAX") for row in settable]),
        _table("double", "fb_most[FB_FIRST_READING]", [_bound(row.most, "DBL_MAX") for row in settable]),
        _table("double", "fb_parameter_starts[]", [repr(float(r.start)) for r in model.parameters]),
        _table("char *const", "fb_state_names[FB_STATES]", [f'"{state.name}"' for state in model.states]),
        _table(
            "double",
            "fb_state_nominals[FB_STATES]",
            [repr(nominals[shown[i]] or 1.0) for i in range(len(model.states))],
        ),
        _table("int", "fb_state_of_reading[FB_READINGS]", [str(i) for i in program.states_of_readings]),
        _table("int", "fb_settable_state[FB_READINGS]", [str(i) for i in program.settable_states]),
        _table("int", "fb_switch_readings[]", [str(i) for i in program.switch_readings]),
        *(_function(block) for block in program.blocks),
    )
    slopes = (_tangent_function(tangents(block)) for block in program.blocks if block.name != "indicators")
    return {
        "model.h": "".join(f"#define {name} {value}\n" for name, value in sizes.items()),
        "model.c": "\n".join(parts),
        "tangents.c": "\n".join((head, include, *slopes)),
    }


def _bound(value: float | None, none: str) -> str:
    return none if value is None else repr(float(value))


def _table(kind: str, name: str, entries: Sequence[str]) -> str:
    # C knows no empty table.
    rows = "".join(f"  {entry},\n" for entry in entries or ("0",))
    return f"const {kind} {name} = {{\n{rows}}};\n"


def body(block: Block) -> Iterator[tuple[str, str]]:
    """Yield the lines of a block as (target, value), in order: temporaries, then places."""
    yield from ((str(symbol.name), c_text(value)) for symbol, value in block.shared)
    yield from ((f"{block.target}[{place}]", c_text(value)) for place, value in block.results)


def _function(block: Block) -> str:
    read = [name for name in block.reads if name != block.target]
    signature = ", ".join(f"FB_CONST {name}" for name in read)
    used = "".join(f"  (void){name};\n" for name in (*read, block.target))
    lines = "".join(_statement(*line) for line in body(block))
    return f"void fb_{block.name}({signature}, FB_TARGET {block.target}) {{\n{used}{lines}}}\n"


def _statement(target: str, value: str) -> str:
    return f"  {target} = {value};\n" if target.endswith("]") else f"  const double {target} = {value};\n"


def _tangent_function(tangent: TangentBlock) -> str:
    block = tangent.block
    target = f"d{block.target}"
    arrays = [*block.reads, *(f"d{name}" for name in block.reads if name != block.target)]
    if block.target == "s":  # derived starts are written from the free ones, in place
        arrays.insert(0, "s")
    signature = ", ".join(f"FB_CONST {name}" for name in arrays)
    lines = [f"  (void){name};\n" for name in (*arrays, target)]
    lines += [_statement(str(symbol), c_text(value)) for symbol, value in tangent.shared]
    lines += [f"  {target}[{place}] = {c_text(slope)};\n" for place, slope in tangent.results]
    return f"void fb_{block.name}_tangent({signature}, FB_TARGET {target}) {{\n{''.join(lines)}}}\n"
