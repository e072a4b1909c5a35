"""Equations to straight-line blocks: parameters' parts hoisted, common subexpressions shared.

C code, its tangents and its reference in Python are all printed from these blocks, so they say the same.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import sympy as sp
from sympy.core.cache import clear_cache

from fmu.errors import PlantError
from fmu.export.model import Expression, Model, Output
from fmu.export.reciprocals import Lines, with_reciprocals

PROMPT_NODES: Final = 30
"""Terms of an output that is computed with each step; one of more is computed when it is read."""


class UnsupportedError(PlantError):
    """An expression or a table that this exporter has no deterministic code for."""


@dataclass(frozen=True, slots=True)
class Block:
    """One function: arrays that it reads (a letter each), what it computes, places that it writes."""

    name: str
    reads: str
    target: str
    shared: Lines
    results: tuple[tuple[int, Expression], ...]


@dataclass(frozen=True)
class ModelCode:
    """All blocks of one model. Arrays: p parameters, k constants, u inputs, s states."""

    model: Model

    @cached_property
    def outputs(self) -> tuple[Output, ...]:
        """Outputs: first the prompt ones."""
        rows = [row for row in self.model.outputs if not row.local]
        return tuple(sorted(rows, key=lambda row: not _prompt(row)))

    @cached_property
    def prompt(self) -> int:
        """Number of outputs that are states, or little more, as all that a drive measures: read each step."""
        return sum(map(_prompt, self.outputs))

    @cached_property
    def locals(self) -> tuple[Output, ...]:
        """Variables computed only on request; events and states that are not shown are among them."""
        rows = [row for row in self.model.outputs if row.local]
        shown = {row.expression for row in self.model.outputs}
        rows += [
            Output(event.name, event.unit, event.description, event.expression, local=True)
            for event in self.model.events
        ]
        rows += [
            Output(state.name, state.unit, f"state {state.name}", real(state.name), local=True)
            for state in self.model.states
            if real(state.name) not in shown
        ]
        return tuple(rows)

    @cached_property
    def readings(self) -> tuple[Output, ...]:
        """Outputs, then locals."""
        return self.outputs + self.locals

    @cached_property
    def states_of_readings(self) -> tuple[int, ...]:
        """State of each reading, -1 where it is computed."""
        position = {real(state.name): i for i, state in enumerate(self.model.states)}
        return tuple(position.get(row.expression, -1) for row in self.readings)

    @cached_property
    def settable_states(self) -> tuple[int, ...]:
        """State that the start value of each reading sets, -1 where there is none."""
        free = [sp.sympify(state.start).is_number for state in self.model.states]
        return tuple(state if state >= 0 and free[state] else -1 for state in self.states_of_readings)

    @cached_property
    def switch_readings(self) -> tuple[int, ...]:
        """Indexes of the readings that are switches."""
        return tuple(i for i, row in enumerate(self.readings) if row.switch)

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """Constants, starts, rates, prompt and derived outputs, locals, event indicators."""
        # SymPy's cache knows the parts of the same model from before: equal, and not the same, which it finds
        # out part by part; for minutes, where parts are shared.
        clear_cache()
        model = self.model
        hoister = _Hoister(frozenset(real(row.name) for row in model.parameters))
        rates = [hoister.hoist(state.rate) for state in model.states]
        readings = [hoister.hoist(row.expression) for row in self.readings]
        starts = [hoister.hoist(sp.sympify(state.start)) for state in model.states]
        events = [hoister.hoist(event.expression) for event in model.events]
        # The shell's reset writes zeros; derived starts follow the parameters.
        derived = [i for i, start in enumerate(starts) if start.free_symbols]
        if any(starts[i] != 0 for i in range(len(starts)) if i not in derived):
            raise UnsupportedError("a state's start must be 0 or an expression in parameters and states")
        names = _places("p", [row.name for row in model.parameters])
        names |= _places("u", [row.name for row in model.inputs])
        names |= _places("s", [state.name for state in model.states])
        names |= _places("k", [symbol.name for symbol in hoister.constants.values()])
        prompt, count = self.prompt, len(self.outputs)
        return (
            _block("constants", "p", "k", list(hoister.constants), names=names),
            _block("starts", "pk", "s", [starts[i] for i in derived], names=names, places=derived),
            _block("rates", "supk", "rate", rates, names=names),
            _block("outputs", "supk", "reading", readings[:prompt], names=names),
            _block(
                "derived", "supk", "reading", readings[prompt:count], names=names, places=range(prompt, count)
            ),
            _block(
                "locals", "supk", "reading", readings[count:], names=names, places=range(count, len(readings))
            ),
            _block("indicators", "supk", "indicator", events, names=names),
        )


class _Hoister:
    """Replacement of terms in parameters alone by constants that are computed once.

    Expressions share their parts, so each part is looked at once.
    """

    def __init__(self, parameters: frozenset[Expression]) -> None:
        self._parameters = parameters
        self._fixed: dict[Expression, bool] = {}
        self._hoisted: dict[Expression, Expression] = {}
        self.constants: dict[Expression, Expression] = {}

    def hoist(self, expression: Expression) -> Expression:
        """Return the expression with its constant parts named."""
        if expression.is_Symbol or expression.is_number:
            return expression
        if expression not in self._hoisted:
            self._hoisted[expression] = self._looked_at(expression)
        return self._hoisted[expression]

    def _looked_at(self, expression: Expression) -> Expression:
        if self._is_fixed(expression):
            return self._named(expression)
        if expression.is_Add or expression.is_Mul:
            # Sums and products are split: the fixed factors of a moving term become one constant.
            fixed = [part for part in expression.args if self._is_fixed(part)]
            moving = [self.hoist(part) for part in expression.args if not self._is_fixed(part)]
            group = expression.func(*fixed)
            if not group.is_number:
                group = self._named(group)
            return expression.func(group, *moving)
        return expression.func(*(self.hoist(part) for part in expression.args))

    def _is_fixed(self, expression: Expression) -> bool:
        if expression.is_Symbol:
            return expression in self._parameters
        if expression not in self._fixed:
            self._fixed[expression] = all(self._is_fixed(part) for part in expression.args)
        return self._fixed[expression]

    def _named(self, expression: Expression) -> Expression:
        if expression.is_Symbol:
            return expression
        if expression not in self.constants:
            self.constants[expression] = real(f"k{len(self.constants)}")
        return self.constants[expression]


def _prompt(row: Output) -> bool:
    """Return whether an output is computed with each step: a switch, or made of few terms."""
    found: set[Expression] = set()
    waiting = [sp.sympify(row.expression)]
    while waiting and len(found) <= PROMPT_NODES:
        term = waiting.pop()
        if term not in found:
            found.add(term)
            waiting += term.args
    return row.switch or len(found) <= PROMPT_NODES


def real(name: str) -> Expression:
    """Return the symbol of a real number."""
    return sp.Symbol(name, real=True)


def _places(array: str, names: Sequence[str]) -> dict[Expression, Expression]:
    return {real(name): real(f"{array}[{i}]") for i, name in enumerate(names)}


def _block(
    name: str,
    reads: str,
    target: str,
    expressions: Sequence[Expression],
    *,
    names: Mapping[Expression, Expression],
    places: Sequence[int] | None = None,
) -> Block:
    placed = dict(names)
    apart: dict[Expression, Expression] = {}
    whole = [_placed(e, placed, apart) for e in expressions]
    # Named lines stand in front of the results, so that they take part in the same search.
    shared, reduced = sp.cse([*apart.values(), *whole], sp.numbered_symbols("t", real=True))
    count = len(apart)
    known = [*shared, *zip(apart, reduced[:count], strict=True)]
    lines, results = with_reciprocals(_in_order(known) if apart else tuple(shared), reduced[count:])
    where = range(len(results)) if places is None else places
    return Block(name, reads, target, lines, tuple(zip(where, results, strict=True)))


def _placed(
    expression: Expression, done: dict[Expression, Expression], apart: dict[Expression, Expression]
) -> Expression:
    """Do what `xreplace` does, but look once at each part: written out, the equations have a million.

    What is named gets a symbol, and stands `apart` under it.
    """
    if not expression.args:
        return done.get(expression, expression)
    if expression not in done:
        parts = [_placed(part, done, apart) for part in expression.args]
        if expression.func.__name__ == "named" and parts[0].args:
            symbol = real(f"n{len(apart)}")
            apart[symbol] = parts[0]
            done[expression] = symbol
        elif expression.func.__name__ == "named":
            done[expression] = parts[0]
        else:
            changed = any(new is not old for new, old in zip(parts, expression.args, strict=True))
            done[expression] = expression.func(*parts) if changed else expression
    return done[expression]


def _in_order(lines: Sequence[tuple[Expression, Expression]]) -> Lines:
    """Return temporaries such that each stands behind those that it is made of."""
    values = dict(lines)
    ordered: dict[Expression, Expression] = {}
    for symbol in values:
        waiting = [symbol]
        while waiting:
            needed = [each for each in values[waiting[-1]].free_symbols if each in values]
            # Sorted: sets have another order in each process, and the code must be the same bytes.
            missing = sorted((each for each in needed if each not in ordered), key=str)
            if missing:
                waiting += missing
            else:
                last = waiting.pop()
                ordered.setdefault(last, values[last])
    return tuple(ordered.items())
