# ruff: noqa: INP001 - a script's neighbor, not a package
"""All modules that differ from one in a single place, each with a name that stays when lines move."""

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeAlias

from breaks import changes, is_tuned, names_in

ROOT: Final = Path(__file__).resolve().parent.parent
CODE: Final = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)

REPORT: Final = "__reached__"
"""Function called by an instrumented module, with the line that it comes to."""

Key: TypeAlias = tuple[str, str, str]


@dataclass(frozen=True, slots=True)
class Mutant:
    """One broken version of one module."""

    target: str
    node: int
    """Index of the breakable node, in the order of the source."""
    way: int
    """Index of the way to break it."""
    line: int
    code: str
    """The line of source, without its indentation."""
    change: str
    """Description of the change; the second of the same in such a line ends with `#2`."""
    lines: tuple[int, int] | None
    """The first and the last line of its statement; None where that runs when the module is loaded."""

    @property
    def key(self) -> Key:
        """Key in the list of survivors; line numbers move too easily."""
        return self.target, self.code, self.change

    def tree(self) -> ast.Module:
        """Return the broken module."""
        tree = ast.parse(path_of(self.target).read_text(encoding="utf-8"))
        victim = list(_breakable(tree))[self.node][0]
        _replace(tree, victim, list(changes(victim, names_in(tree)))[self.way][1](victim))
        return ast.fix_missing_locations(tree)


def mutants(target: str) -> Iterator[Mutant]:
    """Yield every mutant of a module, in the order of its source."""
    source = path_of(target).read_text(encoding="utf-8")
    lines, tree = source.splitlines(), ast.parse(source)
    names, seen = names_in(tree), Counter[Key]()
    for number, (node, statement) in enumerate(_breakable(tree)):
        for way, (change, _) in enumerate(changes(node, names)):
            line = getattr(node, "lineno", 1)
            code = lines[line - 1].strip()
            seen[target, code, change] += 1
            again = seen[target, code, change]
            named = change if again == 1 else f"{change} #{again}"
            yield Mutant(target, number, way, line, code, named, statement)


def telling(source: str) -> ast.Module:
    """Return a module that reports each statement in its functions before it runs."""
    tree = ast.parse(source)
    inside = {
        id(node)
        for function in ast.walk(tree)
        if isinstance(function, CODE[:2])
        for node in ast.walk(function)
    }
    for holder in [node for node in ast.walk(tree) if id(node) in inside]:
        for field in ("body", "orelse", "finalbody"):
            body = getattr(holder, field, None)
            if isinstance(body, list):
                setattr(holder, field, [one for statement in body for one in _reported(statement)])
    return ast.fix_missing_locations(tree)


def _reported(statement: ast.stmt) -> Iterator[ast.stmt]:
    # A docstring stays the first.
    if not (isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)):
        call = ast.Call(ast.Name(REPORT, ast.Load()), [ast.Constant(statement.lineno)], [])
        yield ast.copy_location(ast.Expr(call), statement)
    yield statement


def path_of(target: str) -> Path:
    """Return the file of a module of the program, or of an example that its first word names."""
    example = ROOT / "examples" / target.split("/", maxsplit=1)[0]
    return (example / "src" if example.is_dir() else ROOT / "firmware_bridge") / f"{target}.py"


def module_of(target: str) -> str:
    """Return the name by which a module is imported."""
    names = path_of(target).with_suffix("").relative_to(ROOT).parts
    return ".".join(names[3:] if names[0] == "examples" else names)


def _breakable(
    tree: ast.AST, statement: tuple[int, int] | None = None, *, inside: bool = False
) -> Iterator[tuple[ast.AST, tuple[int, int] | None]]:
    """Walk through a tree in the order of its source, past imports, annotations and decorators.

    With each node comes the first and last line of its statement, where that is inside a function.
    """
    for field, value in ast.iter_fields(tree):
        if field in {"annotation", "returns", "decorator_list", "format_spec"}:
            continue
        if field == "slice" and isinstance(value, ast.Tuple):
            # Types, or the two places of an array.
            continue
        body = inside or (isinstance(tree, CODE) and field == "body")
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.Constant) and is_tuned(tree):
                continue
            if isinstance(child, ast.AST) and not _of_types(child):
                mine = _lines(child) if body and isinstance(child, ast.stmt) else statement if body else None
                yield child, mine
                yield from _breakable(child, mine, inside=body)


def _of_types(node: ast.AST) -> bool:
    """Return True if it has no effect when the program runs."""
    match node:
        case ast.Import() | ast.ImportFrom() | ast.Call(func=ast.Name(id="TypeVar")):
            return True
        case ast.Assign(targets=[ast.Name(id="__all__")]):
            return True
        case ast.AnnAssign(annotation=ast.Name(id="TypeAlias")) | ast.keyword(arg="strict"):
            return True
    return False


def _lines(statement: ast.stmt) -> tuple[int, int]:
    """Return its first and last line; of one that holds others those in front of them."""
    inner = getattr(statement, "body", None) or getattr(statement, "cases", None)
    if not inner:
        return statement.lineno, statement.end_lineno or statement.lineno
    first = inner[0].pattern.lineno if isinstance(inner[0], ast.match_case) else inner[0].lineno
    return statement.lineno, max(statement.lineno, first - 1)


def _replace(tree: ast.AST, old: ast.AST, new: ast.AST) -> None:
    if new is old:
        return
    for parent in ast.walk(tree):
        for field, value in ast.iter_fields(parent):
            if value is old:
                setattr(parent, field, new)
            elif isinstance(value, list) and any(item is old for item in value):
                setattr(parent, field, [new if item is old else item for item in value])
