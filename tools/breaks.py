# ruff: noqa: INP001 - a script's neighbour, not a package
"""Ways to break one node of a program: what each is called, and what turns the node into its successor.

It refuses to know which nodes a module has, and that some ways do nothing there.
"""

import ast
import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Final, TypeAlias

Change: TypeAlias = tuple[str, Callable[[ast.AST], ast.AST]]
"""What is different, and what changes the node or returns another one in its place."""

COMPARISONS: Final[dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
ARITHMETIC: Final[dict[type[ast.operator], type[ast.operator]]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Pow: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
CALLS: Final = {
    "min": "max",
    "max": "min",
    "any": "all",
    "all": "any",
    "radians": "degrees",
    "degrees": "radians",
}
LEFT_OUT: Final = {"abs", "to_seconds", "from_seconds", "radians", "degrees"}
"""Calls in whose place their argument may stand."""
SYMMETRIC: Final = {"min", "max", "hypot", "isclose", "zip"}
"""Calls that do the same with their arguments in another order, or nearly so."""
OF_TYPES: Final = {"TypeVar", "NewType", "cast", "isinstance", "issubclass", "getattr", "hasattr"}
"""Calls whose arguments nobody mixes up, or that nobody asks when the program runs."""
OPPOSITES: Final = (
    ("left", "right"),
    ("front", "rear"),
    ("low", "high"),
    ("lower", "upper"),
    ("lowest", "highest"),
    ("min", "max"),
    ("first", "last"),
    ("begin", "end"),
    ("above", "below"),
)
UNITS: Final = (
    (("SECOND", "MILLISECOND"), ("MILLISECOND", "MICROSECOND"), ("MICROSECOND", "MILLISECOND")),
    (1000, 1e3, 1e-3, 1e6, 1e-6, 3600, 60, 60.0),
)
"""Names of units and what each is taken for; numbers that turn one unit into another."""

_OPPOSITE: Final = {a: b for one, other in OPPOSITES for a, b in ((one, other), (other, one))}
_TAKEN_FOR: Final = dict(UNITS[0])


def changes(node: ast.AST, names: frozenset[str]) -> Iterator[Change]:
    """Yield the ways in which a node may be broken; `names` are all that its module uses."""
    match node:
        case ast.Compare() | ast.BoolOp() | ast.BinOp() | ast.UnaryOp():
            yield from _other_operators(node)
        case ast.Constant():
            yield from _other_constants(node, names)
        case ast.Call():
            yield from _other_calls(node)
        case ast.Name(ctx=ast.Load()) | ast.Attribute(ctx=ast.Load()):
            yield from _other_names(node, names)
        case _:
            yield from _other_flow(node)


def opposite_of(name: str, names: frozenset[str]) -> str | None:
    """Return the opposite of a name, or of a word in it, where the module uses that, too; else None."""
    words = re.split("(_)", name)
    for place, word in enumerate(words):
        if word in _OPPOSITE:
            other = "".join((*words[:place], _OPPOSITE[word], *words[place + 1 :]))
            return other if other in names else None
    return None


def names_in(tree: ast.AST) -> frozenset[str]:
    """Return all names, attributes and texts of a module that could be taken for each other."""
    found = set()
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name):
                found.add(name)
            case ast.Constant(value=str() as text) if text.isidentifier():
                found.add(text)
    return frozenset(found)


def _other_operators(node: ast.expr) -> Iterator[Change]:
    match node:
        case ast.Compare(ops=[operator]):
            for other in COMPARISONS[type(operator)]:
                yield f"{_name(operator)} -> {other.__name__}", _compares(other)
        case ast.BoolOp(op=operator):
            opposite = ast.Or if isinstance(operator, ast.And) else ast.And
            yield f"{_name(operator)} -> {opposite.__name__}", _set("op", opposite)
        case ast.BinOp():
            yield from _other_arithmetic(node)
        case ast.UnaryOp(op=ast.Not() | ast.USub(), operand=operand):
            yield f"without {_name(node.op)}", lambda _old: operand


def _other_arithmetic(node: ast.BinOp) -> Iterator[Change]:
    wrong = ARITHMETIC.get(type(node.op))
    if wrong is not None:
        yield f"{_name(node.op)} -> {wrong.__name__}", _set("op", wrong)
    if isinstance(node.op, ast.Mult | ast.Div | ast.FloorDiv):
        for unit, rest in ((node.right, node.left), (node.left, node.right)):
            if _is_unit(unit):
                yield f"without {ast.unparse(unit)}", lambda _old, rest=rest: rest  # type: ignore[misc]
                return


def _other_names(node: ast.Name | ast.Attribute, names: frozenset[str]) -> Iterator[Change]:
    field, name = ("id", node.id) if isinstance(node, ast.Name) else ("attr", node.attr)
    if name in CALLS:
        return
    wrong = opposite_of(name, names)
    if isinstance(node, ast.Name):
        wrong = _TAKEN_FOR.get(name, wrong)
    if wrong is not None:
        yield f"{name} -> {wrong}", _set(field, lambda: wrong)


def _other_constants(node: ast.Constant, names: frozenset[str]) -> Iterator[Change]:
    match node.value:
        case bool() as flag:
            yield f"{flag} -> {not flag}", _set("value", lambda: not flag)
        case int() as whole:
            yield f"{whole} -> {whole + 1}", _set("value", lambda: whole + 1)
            if whole > 1:
                yield f"{whole} -> {whole - 1}", _set("value", lambda: whole - 1)
        case float() as real:
            yield f"{real} -> {real * 1.01 + 1e-6!r}", _set("value", lambda: real * 1.01 + 1e-6)
        case str() as text if text.isidentifier() and opposite_of(text, names) is not None:
            wrong = opposite_of(text, names)
            yield f"'{text}' -> '{wrong}'", _set("value", lambda: wrong)


def _other_calls(node: ast.Call) -> Iterator[Change]:
    called = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
    if called in OF_TYPES:
        return
    if called in CALLS:
        yield f"{called} -> {CALLS[called]}", _calls(CALLS[called])
    if called in LEFT_OUT and len(node.args) == 1 and not node.keywords:
        yield f"without {called}", lambda _old: node.args[0]
    if called not in SYMMETRIC:
        yield from _other_order(node)


def _other_order(node: ast.Call) -> Iterator[Change]:
    for place, (one, other) in enumerate(pairwise(node.args)):
        if _of_a_kind(one, other):
            yield f"arguments {place + 1} and {place + 2} swapped", _swapped(node.args, place)
    for kept, next_ in pairwise(node.keywords):
        if kept.arg and next_.arg and _of_a_kind(kept.value, next_.value):
            yield f"{kept.arg} and {next_.arg} swapped", _values_swapped(kept, next_)


def _other_flow(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.If() | ast.IfExp():
            condition = node.test
            yield "condition inverted", _set("test", lambda: ast.UnaryOp(ast.Not(), condition))
        case ast.Return(value=ast.expr() as value) if not _is_none(value):
            yield "returns None", _set("value", lambda: ast.Constant(None))
        case (
            ast.Expr(value=ast.Call())
            | ast.AugAssign()
            | ast.Assign(targets=[ast.Attribute() | ast.Subscript()])
        ):
            yield "statement left out", lambda _old: ast.Pass()


def _of_a_kind(one: ast.expr, other: ast.expr) -> bool:
    """Return whether two values could be mixed up: no texts, no functions, and not the same twice."""
    kinds = (ast.Name, ast.Attribute, ast.Call, ast.BinOp, ast.UnaryOp, ast.Subscript)
    numbers = (int, float)

    def could_be(it: ast.expr) -> bool:
        return isinstance(it, kinds) or (isinstance(it, ast.Constant) and type(it.value) in numbers)

    return could_be(one) and could_be(other) and ast.dump(one) != ast.dump(other)


def _is_unit(node: ast.expr) -> bool:
    match node:
        case ast.Constant(value=int() | float() as value):
            return value in UNITS[1]
        case ast.Name(id=name):
            return name in _TAKEN_FOR
    return False


def _swapped(values: list[ast.expr], place: int) -> Callable[[ast.AST], ast.AST]:
    def apply(node: ast.AST) -> ast.AST:
        values[place], values[place + 1] = values[place + 1], values[place]
        return node

    return apply


def _values_swapped(one: ast.keyword, other: ast.keyword) -> Callable[[ast.AST], ast.AST]:
    def apply(node: ast.AST) -> ast.AST:
        one.value, other.value = other.value, one.value
        return node

    return apply


def _set(field: str, value: Callable[[], object]) -> Callable[[ast.AST], ast.AST]:
    def apply(node: ast.AST) -> ast.AST:
        setattr(node, field, value())
        return node

    return apply


def _calls(other: str) -> Callable[[ast.AST], ast.AST]:
    def apply(node: ast.AST) -> ast.AST:
        function = node.func  # type: ignore[attr-defined]
        setattr(function, "id" if isinstance(function, ast.Name) else "attr", other)
        return node

    return apply


def _compares(other: type[ast.cmpop]) -> Callable[[ast.AST], ast.AST]:
    return _set("ops", lambda: [other()])


def _name(node: ast.AST) -> str:
    return type(node).__name__


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None
