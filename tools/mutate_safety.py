"""Mutation campaign: break the safety code in one place at a time; its tests must notice every time.

Run it as `python tools/mutate_safety.py [-j N] [-k TEXT]`. It exits with 1 when a mutant survives that is not in
`tools/mutate_survivors.toml`, or when that list names one that does not.

Each mutant runs in a fork of this process, which has imported everything that is not mutated; only the fast
tests of the mutated module run, and the first failure ends the run.
"""

import argparse
import ast
import copy
import importlib.abc
import importlib.machinery
import os
import signal
import sys
import time
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, ModuleType
from typing import Final

import pytest

import firmware_bridge.motion.davis
import firmware_bridge.motion.lift
import firmware_bridge.robot
import firmware_bridge.wire.cia402
import firmware_bridge.wire.epos2.rows  # noqa: F401 - all of these: paid for once, before the forks

ROOT: Final = Path(__file__).resolve().parent.parent
SURVIVORS: Final = ROOT / "tools" / "mutate_survivors.toml"
TIMEOUT_S: Final = 30
GATE_TESTS: Final = ("safety/test_gate_stops.py", "safety/test_gate_limits.py")
GUARD_TESTS: Final = (
    "safety/test_guard_power.py",
    "safety/test_guard_watch.py",
    "safety/test_guard_frames.py",
    "safety/test_guard_writes.py",
)
TARGETS: Final = {
    "motion/ramp": ("unit/motion/test_ramp.py",),
    "safety/interlocks": GATE_TESTS,
    "safety/limits": (*GATE_TESTS[::-1],),
    "safety/gate": GATE_TESTS,
    "safety/guard": GUARD_TESTS,
    "safety/guard_axis": GUARD_TESTS,
    "safety/guard_rules": GUARD_TESTS[::-1],
    "safety/guard_writes": GUARD_TESTS[::-1],
}
"""Modules of `firmware_bridge`, and the tests of `hil_tests` that must kill their mutants."""

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
    line: int
    code: str
    """The line of source, without its indentation."""
    change: str
    tree: ast.Module

    @property
    def key(self) -> tuple[str, str, str]:
        """What names it in the list of survivors; line numbers move too easily."""
        return self.target, self.code, self.change


def changes(node: ast.AST) -> Iterator[Change]:
    """Yield the ways in which a node may be broken: a name, and what takes a copy of it to its successor."""
    match node:
        case ast.Compare(ops=[operator]):
            for other in COMPARISONS[type(operator)]:
                yield f"{_name(operator)} -> {other.__name__}", _compares(other)
        case ast.BoolOp(op=operator):
            other_op = ast.Or if isinstance(operator, ast.And) else ast.And
            yield f"{_name(operator)} -> {other_op.__name__}", _set("op", other_op)
        case ast.UnaryOp(op=ast.Not() | ast.USub()):
            yield f"without {_name(node.op)}", lambda copied: copied.operand  # type: ignore[attr-defined]
        case ast.BinOp(op=operator) if type(operator) in ARITHMETIC:
            yield (
                f"{_name(operator)} -> {ARITHMETIC[type(operator)].__name__}",
                _set("op", ARITHMETIC[type(operator)]),
            )
        case ast.Constant(value=bool() as flag):
            yield f"{flag} -> {not flag}", _set("value", lambda: not flag)
        case ast.Constant(value=int() as whole):
            yield f"{whole} -> {whole + 1}", _set("value", lambda: whole + 1)
        case ast.Constant(value=float() as real):
            yield f"{real} -> {real * 1.01 + 1e-6!r}", _set("value", lambda: real * 1.01 + 1e-6)
        case ast.If() | ast.IfExp():
            yield "condition inverted", _invert
        case ast.Return(value=ast.expr() as value) if not _is_none(value):
            yield "returns None", _set("value", lambda: ast.Constant(None))
        case ast.Call(func=ast.Name(id=name)) if name in CALLS:
            yield f"{name} -> {CALLS[name]}", _set("func", lambda: ast.Name(CALLS[name], ast.Load()))
        case ast.Expr(value=ast.Call()) | ast.AugAssign():
            yield "statement left out", lambda _copied: ast.Pass()
        case ast.Assign(targets=[ast.Attribute() | ast.Subscript()]):
            yield "statement left out", lambda _copied: ast.Pass()


def mutants(target: str) -> Iterator[Mutant]:
    """Yield every mutant of a module, in the order of its source."""
    source = path_of(target).read_text(encoding="utf-8")
    tree = ast.parse(source)
    lines = source.splitlines()
    for number, node in enumerate(_breakable(tree)):
        for change, apply in changes(node):
            broken = copy.deepcopy(tree)
            victim = list(_breakable(broken))[number]
            _replace(broken, victim, apply(victim))
            line = getattr(node, "lineno", 0)
            yield Mutant(target, line, lines[line - 1].strip(), change, ast.fix_missing_locations(broken))


def path_of(target: str) -> Path:
    """Return the file of a module."""
    return ROOT / "firmware_bridge" / f"{target}.py"


def _breakable(tree: ast.AST) -> Iterator[ast.AST]:
    """Walk through a tree in the order of its source, past imports, annotations, decorators and texts."""
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


def _invert(node: ast.AST) -> ast.AST:
    if isinstance(node, ast.If | ast.IfExp):
        node.test = ast.UnaryOp(ast.Not(), node.test)
    return node


def _name(node: ast.AST) -> str:
    return type(node).__name__


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


class _Loader(importlib.machinery.SourceFileLoader):
    """Loads the mutant in place of the module."""

    def __init__(self, name: str, path: Path, tree: ast.Module) -> None:
        super().__init__(name, str(path))
        self._tree = tree

    def get_code(self, fullname: str) -> CodeType:
        del fullname
        return compile(self._tree, self.path, "exec")


class _Finder(importlib.abc.MetaPathFinder):
    """Finds the mutant before the module."""

    def __init__(self, loader: _Loader) -> None:
        self._loader = loader

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        del path, target
        if fullname != self._loader.name:
            return None
        return importlib.machinery.ModuleSpec(fullname, self._loader, origin=self._loader.path)


def begin(target: str, tree: ast.Module | None) -> int:
    """Fork a run of the module's tests against a mutant of it, or against itself; return its process."""
    sys.stdout.flush()
    child = os.fork()
    if child:
        return child
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    signal.alarm(TIMEOUT_S)
    if tree is not None:
        name = "firmware_bridge." + target.replace("/", ".")
        sys.meta_path.insert(0, _Finder(_Loader(name, path_of(target), tree)))
    files = [str(ROOT / "hil_tests" / file) for file in TARGETS[target]]
    plugins = [f"-pno:{plugin}" for plugin in ("cacheprovider", "xdist")]
    try:
        status = int(pytest.main(["-x", "-q", f"--rootdir={ROOT}", *plugins, *files]))
    except BaseException:  # noqa: BLE001 - a mutant may fail in any way, and all of them are noticed
        status = 1
    os._exit(status)


def survivors(chosen: Iterable[Mutant], jobs: int) -> Iterator[Mutant]:
    """Run all mutants, `jobs` at a time; yield those whose tests passed."""
    running: dict[int, Mutant] = {}

    def ended() -> Iterator[Mutant]:
        child, status = os.wait()
        mutant = running.pop(child)
        if status == 0:
            yield mutant

    for mutant in chosen:
        if len(running) >= jobs:
            yield from ended()
        running[begin(mutant.target, mutant.tree)] = mutant
    while running:
        yield from ended()


def listed() -> dict[tuple[str, str, str], str]:
    """Return the known survivors and why nothing can notice them."""
    rows = tomllib.loads(SURVIVORS.read_text(encoding="utf-8")).get("survivor", [])
    return {(row["module"], row["code"], row["change"]): row["reason"] for row in rows}


def say(text: str) -> None:
    """Tell the user at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def main() -> int:
    """Run the campaign and say what came of it."""
    parser = argparse.ArgumentParser(description="Break the safety code in one place at a time.")
    parser.add_argument("-j", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    parser.add_argument("-k", default="", metavar="TEXT", help="only mutants whose module and line hold this")
    options = parser.parse_args()
    started = time.monotonic()
    for target in TARGETS:
        if os.waitpid(begin(target, None), 0)[1] != 0:
            say(f"{target}: its tests fail before anything is broken")
            return 1
    every = [mutant for target in TARGETS for mutant in mutants(target)]
    chosen = [mutant for mutant in every if options.k in f"{mutant.target} {mutant.code}"]
    alive = sorted(survivors(chosen, options.j), key=lambda mutant: (mutant.target, mutant.line))
    known = listed()
    surprises = [mutant for mutant in alive if mutant.key not in known]
    for mutant in surprises:
        say(f"survived: {mutant.target}.py:{mutant.line}: {mutant.change}: {mutant.code}")
    keys = {mutant.key for mutant in alive}
    tried = {mutant.key for mutant in chosen}
    stale = [key for key in known if key not in keys and (key in tried or not options.k)]
    for target, code, change in stale:
        say(f"listed, but did not survive: {target}.py: {change}: {code}")
    say(
        f"{len(chosen)} mutants, {len(chosen) - len(alive)} noticed, "
        f"{len(alive) - len(surprises)} known survivors, {len(surprises)} surprises, {time.monotonic() - started:.0f} s"
    )
    return 1 if surprises or stale else 0


if __name__ == "__main__":
    sys.exit(main())
