"""A block's lines in order: temporaries, and one loop for each part that there are several copies of."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import TypeAlias

import sympy as sp

from fmu.export.alike import AlikeError, Part, apart
from fmu.export.model import Expression
from fmu.export.reciprocals import Lines, with_reciprocals

Line: TypeAlias = tuple[Expression, Expression]


@dataclass(frozen=True, slots=True)
class Loop:
    """All copies of one part: in its lines PART_PLACE[i] is that of each copy, elsewhere [1] that of one."""

    part: str
    count: int
    takes: tuple[tuple[str, tuple[Expression, ...]], ...]
    """Each array that is read: its name and what each copy has in it."""
    shared: Lines
    gives: tuple[tuple[str, Expression], ...]
    """Each array that is written."""

    def lines(self) -> Iterator[tuple[str, Expression]]:
        """Yield what is computed for each copy, in order: the array's name, and its value."""
        yield from ((_array(line), line[1]) for line in self.shared)
        yield from self.gives

    def unrolled(self) -> Iterator[Line]:
        """Yield the same as temporaries, copy by copy: `PART_PLACE[1]` is called PART_PLACE_1."""
        for copy in range(self.count):
            arrays = [
                *(name for name, _ in (*self.takes, *self.gives)),
                *(_array(line) for line in self.shared),
            ]
            own = {_element(name, "i"): _temporary(name, copy) for name in arrays}
            yield from ((_temporary(name, copy), scalars(values[copy])) for name, values in self.takes)
            yield from ((own[symbol], value.xreplace(own)) for symbol, value in self.shared)
            yield from ((_temporary(name, copy), value.xreplace(own)) for name, value in self.gives)


Step: TypeAlias = Line | Loop


def steps(
    expressions: Sequence[Expression], names: Mapping[Expression, Expression]
) -> tuple[tuple[Step, ...], list[Expression]]:
    """Return what to compute in order, and the expressions in terms of it; `names` places model symbols."""
    whole, parts = apart(expressions)
    loops = {part.name: _loop(part, names) for part in parts}
    taken = [value for loop in loops.values() for _, values in loop.takes for value in values]
    shared, reduced = sp.cse(
        [value.xreplace(names) for value in (*whole, *taken)], sp.numbered_symbols("t", real=True)
    )
    lines, reduced = with_reciprocals(tuple(shared), reduced)
    rest = iter(reduced[len(whole) :])
    for name, loop in loops.items():
        takes = tuple((array, tuple(next(rest) for _ in values)) for array, values in loop.takes)
        loops[name] = Loop(name, loop.count, takes, loop.shared, loop.gives)
    return tuple(_in_order(lines, loops)), reduced[: len(whole)]


def scalars(expression: Expression) -> Expression:
    """Return an expression that reads from loops' arrays in terms of the temporaries of unrolled loops."""
    return expression.xreplace(
        {
            symbol: _temporary(*symbol.name[:-1].split("["))
            for symbol in expression.free_symbols
            if "_" in symbol.name and symbol.name.endswith("]")
        }
    )


def _loop(part: Part, names: Mapping[Expression, Expression]) -> Loop:
    shared, results = sp.cse(
        [value.xreplace(names) for value in part.gives.values()],
        (_element(f"{part.name}_t{n}", "i") for n in count()),
    )
    lines, results = with_reciprocals(tuple(shared), results, f"{part.name}_r{{}}[i]")
    return Loop(
        part.name,
        len(part.copies),
        tuple((f"{part.name}_{place}", part.values(place)) for place in part.takes),
        lines,
        tuple((f"{part.name}_{place}", value) for place, value in zip(part.gives, results, strict=True)),
    )


def _in_order(lines: Sequence[Line], loops: Mapping[str, Loop]) -> Iterator[Step]:
    """Yield each after what it needs: a loop when all copies have what they take."""
    waiting, todo = list(lines), dict(loops)
    unknown = {symbol for symbol, _ in lines}
    unknown |= {
        _element(name, copy)
        for loop in loops.values()
        for name, _ in loop.gives
        for copy in range(loop.count)
    }
    while waiting or todo:
        line = next((line for line in waiting if not line[1].free_symbols & unknown), None)
        if line is not None:
            yield line
            waiting.remove(line)
            unknown.remove(line[0])
            continue
        loop = next((loop for loop in todo.values() if not _needs(loop) & unknown), None)
        if loop is None:
            raise AlikeError(f"copies of {', '.join(todo)} take what depends on what others of them give")
        yield loop
        del todo[loop.part]
        unknown -= {_element(name, copy) for name, _ in loop.gives for copy in range(loop.count)}


def _array(line: Line) -> str:
    return str(line[0].name).removesuffix("[i]")


def _needs(loop: Loop) -> set[Expression]:
    return set().union(*(value.free_symbols for _, values in loop.takes for value in values))


def _element(array: str, index: int | str) -> Expression:
    return sp.Symbol(f"{array}[{index}]", real=True)


def _temporary(array: str, copy: int | str) -> Expression:
    return sp.Symbol(f"{array}_{copy}", real=True)
