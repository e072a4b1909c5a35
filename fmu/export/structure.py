"""Dependencies of the variables: the ModelStructure of both FMI versions, read off the equations.

A dependency that only cancels numerically is listed all the same.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum

import sympy as sp

from fmu.export.blocks import ModelCode, real
from fmu.export.model import Expression
from fmu.export.variables import Variable, event_references, first_reading, state_references, variables


class DependencyKind(IntEnum):
    """Kinds of dependency of an unknown on a known, weakest first; the names are FMI's."""

    constant = 1
    fixed = 2
    dependent = 3


@dataclass(frozen=True, slots=True)
class Unknown:
    """A variable that the FMU computes, and the value references that it is computed from."""

    reference: int
    dependencies: tuple[tuple[int, DependencyKind], ...]


@dataclass(frozen=True, slots=True)
class Structure:
    """Outputs, rates and event indicators while time runs; everything computed at initialization."""

    outputs: tuple[Unknown, ...]
    rates: tuple[Unknown, ...]
    initial: tuple[Unknown, ...]
    events: tuple[Unknown, ...]


def structure(program: ModelCode) -> Structure:
    """Return the dependencies of one model."""
    model = program.model
    rows = variables(program)
    by_state = dict(zip((real(s.name) for s in model.states), state_references(program), strict=True))
    inputs = {real(row.name): 1 + i for i, row in enumerate(model.inputs)}
    known = inputs | by_state
    first = first_reading(program)
    rates = [(rows[first + len(program.readings) + i], s.rate) for i, s in enumerate(model.states)]
    outputs = [(rows[first + i], row.expression) for i, row in enumerate(program.outputs)]
    events = [
        (rows[reference], event.expression)
        for reference, event in zip(event_references(program), model.events, strict=True)
    ]
    # At initialization parameters and free start values are known, and derived starts are not.
    fixed = {real(row.name): len(inputs) + 1 + i for i, row in enumerate(model.parameters)}
    derived = {real(s.name): sp.sympify(s.start) for s in model.states if not sp.sympify(s.start).is_number}
    starting = known | fixed
    for symbol in derived:
        del starting[symbol]
    unknown = [(row, expression) for row, expression in outputs if row.initial == "calculated"]
    unknown += [(rows[by_state[symbol]], start) for symbol, start in derived.items()]
    return Structure(
        tuple(_unknowns(outputs, known)),
        tuple(_unknowns(rates, known)),
        tuple(_initial([*unknown, *rates], starting, derived)),
        tuple(_unknowns(events, known)),
    )


def _unknowns(
    rows: Sequence[tuple[Variable, Expression]], known: Mapping[Expression, int]
) -> Iterator[Unknown]:
    for row, expression in rows:
        kinds = _kinds(expression, known, {})
        found = sorted((known[symbol], kind) for symbol, kind in kinds.items())
        yield Unknown(row.reference, tuple(found))


def _initial(
    rows: Sequence[tuple[Variable, Expression]],
    known: Mapping[Expression, int],
    derived: Mapping[Expression, Expression],
) -> Iterator[Unknown]:
    seen = set()
    memory: dict[Expression, frozenset[Expression]] = {}
    for row, expression in sorted(rows, key=lambda row: row[0].reference):
        if row.reference in seen:
            continue
        seen.add(row.reference)
        free = _symbols(sp.sympify(expression), memory)
        # A derived start may be made of other derived starts: down to what a user can set.
        while more := free & derived.keys():
            free = (free - more).union(*(_symbols(derived[symbol], memory) for symbol in more))
        yield Unknown(
            row.reference, tuple(sorted((known[symbol], DependencyKind.dependent) for symbol in free))
        )


def _symbols(
    expression: Expression, memory: dict[Expression, frozenset[Expression]]
) -> frozenset[Expression]:
    """Return the symbols in an expression; SymPy's own way looks at shared parts again and again."""
    if expression not in memory:
        parts = (_symbols(part, memory) for part in expression.args)
        memory[expression] = (
            frozenset({expression}) if expression.is_Symbol else frozenset[Expression]().union(*parts)
        )
    return memory[expression]


def _kinds(
    expression: Expression,
    known: Mapping[Expression, int],
    memory: dict[Expression, dict[Expression, DependencyKind]],
) -> dict[Expression, DependencyKind]:
    """Return the knowns in an expression, and how it depends on each."""
    if expression.is_Symbol:
        return {expression: DependencyKind.constant} if expression in known else {}
    if expression in memory:
        return memory[expression]
    parts = [_kinds(part, known, memory) for part in expression.args]
    moving = [part for part in parts if part]
    found: dict[Expression, DependencyKind] = {}
    # Any function but a sum, or a product with what does not move, has a slope that changes.
    least = DependencyKind.dependent
    if expression.is_Add:
        least = DependencyKind.constant
    elif expression.is_Mul and len(moving) == 1:
        others = (arg for arg, part in zip(expression.args, parts, strict=True) if not part)
        least = DependencyKind.fixed if any(arg.free_symbols for arg in others) else DependencyKind.constant
    for part in moving:
        for symbol, kind in part.items():
            found[symbol] = max(kind, least, found.get(symbol, least))
    memory[expression] = found
    return found
