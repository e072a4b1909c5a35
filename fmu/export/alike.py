"""What a model has several of, such as wheels: two copies go through one vector register, side by side.

A model marks what each copy takes and gives; to everybody else a mark is its value. Compilers do not find out
by themselves what is alike in equations that SymPy has sorted anew for each copy.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import sympy as sp
from sympy.utilities.lambdify import implemented_function

from fmu.export.model import Expression


def _mark(name: str) -> Expression:
    return implemented_function(sp.Function(name, real=True), _value)


def _value(_part: int, _copy: int, _place: int, value: float) -> float:
    return value


_taken: Final = _mark("taken")
_given: Final = _mark("given")


class AlikeError(Exception):
    """Copies that differ in more than what they take."""


@dataclass(frozen=True, slots=True)
class Copy:
    """One of several parts with the same equations: the part's name, and the copy's own."""

    part: str
    name: str

    def takes(self, place: str, value: Expression) -> Expression:
        """Return the value, marked as what this copy has in this place where others have theirs."""
        return _taken(_number(self.part), _number(self.name), _number(place), value)

    def gives(self, place: str, value: Expression) -> Expression:
        """Return the value, marked as what this copy computes of what it takes and of parameters."""
        return _given(_number(self.part), _number(self.name), _number(place), value)


@dataclass
class Part:
    """All copies of one part: by place what each takes, and once what all give, of `PART_PLACE[i]`."""

    name: str
    copies: list[str]
    takes: dict[str, dict[str, Expression]] = field(default_factory=dict)
    gives: dict[str, Expression] = field(default_factory=dict)

    def element(self, place: str, copy: str) -> Expression:
        """Return the symbol of what this copy gives."""
        return _symbol(f"{self.name}_{place}[{self.copies.index(copy)}]")

    def values(self, place: str) -> tuple[Expression, ...]:
        """Return what each copy takes in this place."""
        taken = self.takes[place]
        if missing := [copy for copy in self.copies if copy not in taken]:
            raise AlikeError(f"{self.name} takes {place} in some copies, but not in {missing[0]}")
        return tuple(taken[copy] for copy in self.copies)


def is_mark(expression: Expression) -> bool:
    """Return whether this is a mark, whose value is its last argument."""
    return expression.func in {_taken, _given}


def plain(expressions: Sequence[Expression]) -> list[Expression]:
    """Return the expressions without marks."""
    memory: dict[Expression, Expression] = {}

    def bare(expression: Expression) -> Expression:
        if expression.is_Atom:
            return expression
        if expression not in memory:
            args = [bare(part) for part in expression.args]
            memory[expression] = args[-1] if is_mark(expression) else expression.func(*args)
        return memory[expression]

    return [bare(sp.sympify(expression)) for expression in expressions]


def apart(expressions: Sequence[Expression]) -> tuple[list[Expression], tuple[Part, ...]]:
    """Return the expressions in terms of what the parts give, and the parts.

    AlikeError where two copies have not the same equations.
    """
    splitter = _Splitter(expressions)
    return [splitter.seen(expression, "") for expression in expressions], tuple(splitter.parts.values())


class _Splitter:
    """Takes expressions apart at their marks; expressions share their parts, so each is looked at once."""

    def __init__(self, expressions: Sequence[Expression]) -> None:
        found: set[Expression] = set().union(*(expression.atoms(_given) for expression in expressions))
        # By name, not as SymPy finds them: the left and the right one of each part lie in the same places.
        names = sorted({(_text(mark.args[0]), _text(mark.args[1])) for mark in found})
        self.parts = {name: Part(name, [copy for part, copy in names if part == name]) for name, _ in names}
        self._memory: dict[tuple[Expression, str], Expression] = {}

    def seen(self, expression: Expression, within: str) -> Expression:
        """Return an expression that stands within the equations of this part, or of none."""
        if expression.is_Atom:
            return expression
        key = (expression, within)
        if key not in self._memory:
            self._memory[key] = self._looked_at(expression, within)
        return self._memory[key]

    def _looked_at(self, expression: Expression, within: str) -> Expression:
        if not is_mark(expression):
            return expression.func(*(self.seen(part, within) for part in expression.args))
        name, copy, place = map(_text, expression.args[:3])
        value = expression.args[-1]
        if expression.func == _given:
            part = self.parts[name]
            equation = self.seen(value, name)
            if part.gives.setdefault(place, equation) != equation:
                raise AlikeError(f"{name} gives {place} by another equation in {copy} than in others")
            return part.element(place, copy)
        if name != within:
            return self.seen(value, within)
        self.parts[name].takes.setdefault(place, {})[copy] = self.seen(value, "")
        return _symbol(f"{name}_{place}[i]")


def _symbol(name: str) -> Expression:
    return sp.Symbol(name, real=True)


def _number(name: str) -> Expression:
    """Return a name as a number: whoever looks for an expression's symbols must not find it."""
    return sp.Integer(int.from_bytes(name.encode()))


def _text(number: Expression) -> str:
    value = int(number)
    return value.to_bytes((value.bit_length() + 7) // 8).decode()
