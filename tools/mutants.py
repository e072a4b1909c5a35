# ruff: noqa: INP001 - a script's neighbour, not a package
"""Ways to break a Python module in one place, and the broken modules themselves."""

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent

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
CALLS: Final = {"min": "max", "max": "min", "any": "all", "all": "any"}

Change = tuple[str, Callable[[ast.AST], ast.AST]]


@dataclass(frozen=True, slots=True)
class Mutant:
    """One broken version of one module."""

    target: str
    node: int
    """Which of the breakable nodes, in the order of the source."""
    way: int
    """Which of the ways to break it."""
    line: int
    code: str
    """The line of source, without its indentation."""
    change: str

    @property
    def key(self) -> tuple[str, str, str]:
        """What names it in the list of survivors; line numbers move too easily."""
        return self.target, self.code, self.change

    def tree(self) -> ast.Module:
        """Return the broken module."""
        tree = ast.parse(path_of(self.target).read_text(encoding="utf-8"))
        victim = list(_breakable(tree))[self.node]
        _replace(tree, victim, list(changes(victim))[self.way][1](victim))
        return ast.fix_missing_locations(tree)


def changes(node: ast.AST) -> Iterator[Change]:
    """Yield the ways in which a node may be broken: a name, and what turns it into its successor."""
    match node:
        case ast.Compare(ops=[operator]):
            for other in COMPARISONS[type(operator)]:
                yield f"{_name(operator)} -> {other.__name__}", _compares(other)
        case ast.BoolOp(op=operator):
            opposite = ast.Or if isinstance(operator, ast.And) else ast.And
            yield f"{_name(operator)} -> {opposite.__name__}", _set("op", opposite)
        case ast.BinOp(op=operator) if type(operator) in ARITHMETIC:
            wrong = ARITHMETIC[type(operator)]
            yield f"{_name(operator)} -> {wrong.__name__}", _set("op", wrong)
        case ast.UnaryOp(op=ast.Not() | ast.USub(), operand=operand):
            yield f"without {_name(node.op)}", lambda _old: operand
        case ast.Constant():
            yield from _other_constants(node)
        case _:
            yield from _other_flow(node)


def _other_constants(node: ast.Constant) -> Iterator[Change]:
    match node.value:
        case bool() as flag:
            yield f"{flag} -> {not flag}", _set("value", lambda: not flag)
        case int() as whole:
            yield f"{whole} -> {whole + 1}", _set("value", lambda: whole + 1)
        case float() as real:
            yield f"{real} -> {real * 1.01 + 1e-6!r}", _set("value", lambda: real * 1.01 + 1e-6)


def _other_flow(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.If() | ast.IfExp():
            condition = node.test
            yield "condition inverted", _set("test", lambda: ast.UnaryOp(ast.Not(), condition))
        case ast.Return(value=ast.expr() as value) if not _is_none(value):
            yield "returns None", _set("value", lambda: ast.Constant(None))
        case ast.Call(func=ast.Name(id=name)) if name in CALLS:
            yield f"{name} -> {CALLS[name]}", _set("func", lambda: ast.Name(CALLS[name], ast.Load()))
        case (
            ast.Expr(value=ast.Call())
            | ast.AugAssign()
            | ast.Assign(targets=[ast.Attribute() | ast.Subscript()])
        ):
            yield "statement left out", lambda _old: ast.Pass()


def mutants(target: str) -> Iterator[Mutant]:
    """Yield every mutant of a module, in the order of its source."""
    source = path_of(target).read_text(encoding="utf-8")
    lines = source.splitlines()
    for number, node in enumerate(_breakable(ast.parse(source))):
        for way, (change, _) in enumerate(changes(node)):
            line = getattr(node, "lineno", 1)
            yield Mutant(target, number, way, line, lines[line - 1].strip(), change)


def path_of(target: str) -> Path:
    """Return the file of a module of the program, or of an example that its first word names."""
    example = ROOT / "examples" / target.split("/", maxsplit=1)[0]
    return (example if example.is_dir() else ROOT / "firmware_bridge") / f"{target}.py"


def module_of(target: str) -> str:
    """Return the name by which a module is imported."""
    names = path_of(target).with_suffix("").relative_to(ROOT).parts
    return ".".join(names[2:] if names[0] == "examples" else names)


def _breakable(tree: ast.AST) -> Iterator[ast.AST]:
    """Walk through a tree in the order of its source, past imports, annotations and decorators."""
    for field, value in ast.iter_fields(tree):
        if field in {"annotation", "returns", "decorator_list", "format_spec"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not isinstance(child, ast.Import | ast.ImportFrom):
                yield child
                yield from _breakable(child)


def _replace(tree: ast.AST, old: ast.AST, new: ast.AST) -> None:
    if new is old:
        return
    for parent in ast.walk(tree):
        for field, value in ast.iter_fields(parent):
            if value is old:
                setattr(parent, field, new)
            elif isinstance(value, list) and any(item is old for item in value):
                setattr(parent, field, [new if item is old else item for item in value])


def _set(field: str, value: Callable[[], object]) -> Callable[[ast.AST], ast.AST]:
    def apply(node: ast.AST) -> ast.AST:
        setattr(node, field, value())
        return node

    return apply


def _compares(other: type[ast.cmpop]) -> Callable[[ast.AST], ast.AST]:
    return _set("ops", lambda: [other()])


def _name(node: ast.AST) -> str:
    return type(node).__name__


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None
