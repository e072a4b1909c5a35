# ruff: noqa: INP001 - a script's neighbor, not a package
"""Ways to break one node of a program: what each is called, and what turns the node into its successor.

Not known here: the nodes of a module, and changes that have no effect there.
"""

import ast
import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Final, TypeAlias

Change: TypeAlias = tuple[str, Callable[[ast.AST], ast.AST]]
"""A change: its description, and the function that changes the node or returns a replacement."""

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
"""Calls whose arguments are never mixed up, or have no effect when the program runs."""
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

TUNED: Final = re.compile(r"(^|_)(MS|US|S|BYTES|LENGTH|SIZE|MOST|WITHIN|AFTER|EVERY|OVER|UP_TO)(_|$)")
"""Names of constants that someone has chosen, a time or the length of a buffer: one more is as right."""
COUNTER: Final = "__import__('builtins').__dict__.setdefault('__times__', __import__('itertools').count())"
"""Expression that counts the executions of the one broken place in a process."""
TIMES: Final = (
    ("only the first time", f"next({COUNTER}) == 0"),
    ("every second time", f"next({COUNTER}) % 2"),
)
STRICT: Final = "strict"
"""Zip's check of lengths; no caller gives it lists of two lengths."""
ALONE: Final = {"min", "max"}
"""Calls in whose place each of their arguments may stand."""

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
        case ast.Tuple(ctx=ast.Load()) | ast.List(ctx=ast.Load()) | ast.Set() | ast.Dict():
            yield from _without_elements(node)
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


def is_tuned(node: ast.AST) -> bool:
    """Return whether a statement gives a constant of tuning its value, or a node is so many units of time."""
    match node:
        case ast.AnnAssign(target=ast.Name(id=name)) | ast.Assign(targets=[ast.Name(id=name)]):
            return name.isupper() and TUNED.search(name) is not None
        case ast.BinOp(op=ast.Mult(), left=ast.Constant(), right=ast.Name(id=unit)):
            return unit in _TAKEN_FOR
    return False


def names_in(tree: ast.AST) -> frozenset[str]:
    """Return all names, attributes and texts of a module that could be taken for each other.

    Of an attribute of something that has a name also both with a point between them.
    """
    found = set()
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name):
                found.add(name)
            case ast.Constant(value=str() as text) if text.isidentifier():
                found.add(text)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id != "self":
            found.add(f"{node.value.id}.{node.attr}")
    return frozenset(found)


def _other_operators(node: ast.expr) -> Iterator[Change]:
    match node:
        case ast.Compare(ops=[operator]):
            for other in COMPARISONS[type(operator)]:
                yield f"{_name(operator)} -> {other.__name__}", _compares(other)
        case ast.BoolOp(op=operator):
            opposite = ast.Or if isinstance(operator, ast.And) else ast.And
            yield f"{_name(operator)} -> {opposite.__name__}", _set("op", opposite)
            for place in range(len(node.values)):
                yield f"without operand {place + 1}", _without("values", place)
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
    elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id.islower():
        others = sorted(it for it in names if it.startswith(f"{node.value.id}."))
        if len(others) > 1:
            mixed = others[(others.index(f"{node.value.id}.{name}") + 1) % len(others)].partition(".")[2]
            yield f"{name} -> {mixed}", _set("attr", lambda: mixed)


def _other_constants(node: ast.Constant, names: frozenset[str]) -> Iterator[Change]:
    match node.value:
        case bool() as flag:
            yield f"{flag} -> {not flag}", _set("value", lambda: not flag)
        case int() as whole:
            yield f"{whole} -> {whole + 1}", _set("value", lambda: whole + 1)
            if whole > 1:
                yield f"{whole} -> {whole - 1}", _set("value", lambda: whole - 1)
        case float() as real:
            other = real * 1.01 if real else 0.01
            yield f"{real} -> {other!r}", _set("value", lambda: other)
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
    yield from _less(node, called)
    if called not in SYMMETRIC:
        yield from _other_order(node)


def _less(node: ast.Call, called: str) -> Iterator[Change]:
    if called in ALONE and len(node.args) > 1:
        for place, argument in enumerate(node.args):
            yield f"argument {place + 1} alone", lambda _old, one=argument: one  # type: ignore[misc]
    for place, keyword in enumerate(node.keywords):
        if keyword.arg and keyword.arg != STRICT:
            yield f"without {keyword.arg}", _without("keywords", place)


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
            yield "always", _set("test", lambda: ast.Constant(value=True))
            yield "never", _set("test", lambda: ast.Constant(value=False))
        case ast.For():
            rounds = node.body
            yield "the first one only", _set("body", lambda: [*rounds, ast.Break()])
        case ast.Return(value=ast.expr() as value) if not _is_nothing(value):
            yield "returns None", _set("value", lambda: ast.Constant(None))
        case (
            ast.Expr(value=ast.Call())
            | ast.AugAssign()
            | ast.Assign(targets=[ast.Attribute() | ast.Subscript()])
        ):
            yield "statement left out", lambda _old: ast.Pass()
            yield from ((when, _if(then)) for when, then in TIMES)


def _without_elements(node: ast.Tuple | ast.List | ast.Set | ast.Dict) -> Iterator[Change]:
    elements = node.values if isinstance(node, ast.Dict) else node.elts
    for place in range(len(elements) if len(elements) > 1 else 0):
        yield f"without element {place + 1}", _without_element(place)


def _without_element(place: int) -> Callable[[ast.AST], ast.AST]:
    def apply(node: ast.AST) -> ast.AST:
        for field in ("elts", "keys", "values"):
            if hasattr(node, field):
                _without(field, place)(node)
        return node

    return apply


def _without(field: str, place: int) -> Callable[[ast.AST], ast.AST]:
    """Leave one out of a list of nodes; where one is left, it stands alone in the place of an operation."""

    def apply(node: ast.AST) -> ast.AST:
        kept = [one for at, one in enumerate(getattr(node, field)) if at != place]
        if isinstance(node, ast.BoolOp) and len(kept) == 1:
            return kept[0]  # type: ignore[no-any-return]
        setattr(node, field, kept)
        return node

    return apply


def _if(condition: str) -> Callable[[ast.AST], ast.AST]:
    def apply(node: ast.AST) -> ast.AST:
        assert isinstance(node, ast.stmt)  # noqa: S101 - who calls it has looked
        return ast.If(ast.parse(condition, mode="eval").body, [node], [])

    return apply


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


def _is_nothing(node: ast.expr) -> bool:
    """Return True if None in its place is equivalent under a test of truth."""
    match node:
        case ast.Constant(value=value):
            return not value
        case ast.Tuple(elts=[]) | ast.List(elts=[]) | ast.Dict(keys=[]):
            return True
    return False
