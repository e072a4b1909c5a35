# ruff: noqa: INP001 - a script's neighbor, not a package
"""Mutants of a module, each against tests that reach its line, in forks of one that has loaded all the rest.

Not known here: which modules are tried, and which mutants may survive.
"""

import gc
import importlib.abc
import importlib.machinery
import os
import pickle
import re
import resource
import signal
import sys
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import CodeType, ModuleType
from typing import Final, NoReturn, TypeVar

import pytest
from hypothesis import Phase, settings
from mutants import REPORT, ROOT, Mutant, module_of, path_of, telling

T = TypeVar("T")

OURS: Final = ("firmware_bridge", "emulators", "fmu", "hil_tests", "diff_drive")
PATIENCE: Final = 4
"""Multiple of its tests' time with nothing broken, plus five seconds, after which a mutant never ends."""
MOST: Final = 60
"""Tests that a mutant meets beside those that are chosen by name, or have the module's in their file's."""
LACKS: Final = 99
"""Exit status of a mutant's process that has not found a test."""
FIRST: Final = 12
"""Tests that a mutant meets first: those that have noticed others. Most get no further."""
QUICK: Final = (
    *("-x", "-q", "--tb=no", "--assert=plain", f"--rootdir={ROOT}", "-mnot long and not vcan and not tshark"),
    *(f"-pno:{name}" for name in ("cacheprovider", "xdist", "hypothesispytest", "unraisableexception")),
)
"""Options without pytest's readable failures, which would take most of a run's time unread."""


class Unsound(Exception):  # noqa: N818 - of the campaign, not of a call
    """The tests' verdict on the mutants is worth nothing; the message has the reason."""


@dataclass(slots=True)
class Reach:
    """Reach of some tests with nothing broken."""

    lines: dict[str, dict[str, set[int]]] = field(default_factory=dict)
    """Lines of each module by each test; under "" those reached while tests are collected."""
    seconds: dict[str, float] = field(default_factory=dict)
    modules: tuple[str, ...] = ()
    """All modules that are loaded then, in that order."""
    cost_s: float = 0.0
    named: frozenset[str] = frozenset()
    """The files that were chosen by their names: no test of theirs is left out."""

    def of(self, mutant: Mutant) -> list[str]:
        """Return the tests that may notice a mutant, the quickest first."""
        tests = self.lines.get(mutant.target, {})
        stem = mutant.target.rpartition("/")[2].removesuffix("s")

        def is_near(test: str) -> bool:
            file = test.partition("::")[0]
            return file in self.named or stem in Path(file).name

        if mutant.lines is None or _between(tests.get("", ()), mutant.lines):
            # What is done when a module is loaded shows wherever it is used, or what it makes.
            chosen = [test for test in self.seconds if tests.get(test) or is_near(test)] or list(self.seconds)
        else:
            chosen = [test for test, lines in tests.items() if _between(lines, mutant.lines)]
        near = [test for test in chosen if is_near(test)]
        others = [test for test in chosen if not is_near(test)]
        # The cases of one test follow each other: to leave some out evenly leaves the most different ones.
        others = others[:: -(-len(others) // MOST) or 1]
        return sorted((*near, *others), key=lambda test: self.seconds[test])


def _between(lines: Collection[int], ends: tuple[int, int]) -> bool:
    return any(line in lines for line in range(ends[0], ends[1] + 1))


class _Loader(importlib.machinery.SourceFileLoader):
    """Loader of the mutant in place of the module."""

    def __init__(self, name: str, mutant: Mutant) -> None:
        super().__init__(name, str(path_of(mutant.target)))
        self._mutant = mutant

    def get_code(self, fullname: str) -> CodeType:
        del fullname
        return compile(self._mutant.tree(), self.path, "exec")


class _Finder(importlib.abc.MetaPathFinder):
    """Finds other modules in the place of some; one that is None no one finds."""

    def __init__(
        self, loaders: dict[str, Callable[[str], importlib.machinery.SourceFileLoader] | None]
    ) -> None:
        self.loaders = loaders

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        del path, target
        if fullname not in self.loaders:
            return None
        make = self.loaders[fullname]
        if make is None:
            raise ImportError(fullname)
        loader = make(fullname)
        return importlib.machinery.ModuleSpec(fullname, loader, origin=loader.path)


class _Same:
    """Pytest's plugin that lets Hypothesis draw the same examples in each process, and shrink none."""

    def pytest_sessionstart(self) -> None:
        phases = (Phase.explicit, Phase.generate)
        settings.register_profile(
            "campaign", settings(deadline=None, derandomize=True, database=None, phases=phases)
        )
        settings.load_profile("campaign")


class _Reached(_Same):
    """Pytest's plugin that notes which statements of modules each test reaches, and its time."""

    def __init__(self, targets: Sequence[str]) -> None:
        self.found = Reach({target: {} for target in targets})
        self.now: dict[str, set[int]] = {target: set() for target in targets}
        """Statements reached since the last note."""
        self._made: dict[str, dict[str, set[int]]] = {}
        """Statements reached by the making of each fixture that tests share."""

    def _note(self, test: str, fixtures: Sequence[str] = ()) -> None:
        for shared in (self._made[name] for name in fixtures if name in self._made):
            for target, lines in shared.items():
                self.now[target].update(lines)
        for target, lines in self.now.items():
            if lines:
                self.found.lines[target].setdefault(test, set()).update(lines)
                lines.clear()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[object]) -> Iterator[None]:
        """Note the reach of a fixture's making for all tests that share it: the first of them makes it."""
        before = {target: set(lines) for target, lines in self.now.items()}
        for lines in self.now.values():
            lines.clear()
        yield
        if fixturedef.scope != "function":
            self._made[fixturedef.argname] = {target: set(lines) for target, lines in self.now.items()}
        for target, lines in before.items():
            self.now[target].update(lines)

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self._note("")
        begun = time.process_time()
        yield
        self.found.seconds[item.nodeid] = time.process_time() - begun
        self._note(item.nodeid, getattr(item, "fixturenames", ()))


class _Telling(importlib.machinery.SourceFileLoader):
    """Loader of a module that reports each statement that it comes to in its functions."""

    def __init__(self, name: str, target: str, show: Callable[[int], None]) -> None:
        super().__init__(name, str(path_of(target)))
        self._report = show

    def get_code(self, fullname: str) -> CodeType:
        del fullname
        return compile(telling(Path(self.path).read_text(encoding="utf-8")), self.path, "exec")

    def exec_module(self, module: ModuleType) -> None:
        vars(module)[REPORT] = self._report
        super().exec_module(module)


class _Order(_Same):
    """Pytest's plugin that runs some tests only, in their order, and writes down which one fails."""

    def __init__(self, tests: Sequence[str], into: int) -> None:
        self._rank = {_once(test): place for place, test in enumerate(tests)}
        self._into = into
        self.lacks: list[str] = []
        """Tests of which no case is there, though nothing has kept pytest from collecting."""

    def pytest_collection_modifyitems(self, session: pytest.Session, items: list[pytest.Item]) -> None:
        found = {_once(item.nodeid) for item in items}
        # What a mutant changes may stand in a case's name: then all cases of its test are run.
        other = {name.partition("[")[0] for name in self._rank if name not in found}
        last = len(self._rank)
        places = {
            item: self._rank.get(_once(item.nodeid), last)
            for item in items
            if _once(item.nodeid) in self._rank or _once(item.nodeid).partition("[")[0] in other
        }
        there = {_once(item.nodeid).partition("[")[0] for item in places}
        self.lacks = [] if session.testsfailed else sorted(other - there)
        items[:] = sorted(places, key=places.__getitem__)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            os.write(self._into, report.nodeid.encode())


def _once(name: str) -> str:
    """Return a test's name without what pytest escapes again each time that a process collects it."""
    return re.sub(r"\\+", "/", name)


def in_a_fork(work: Callable[[], T]) -> T:
    """Return what a fork of this process has worked out, or raise what it has raised."""
    sys.stdout.flush()
    out, into = os.pipe()
    child = os.fork()
    if not child:
        with os.fdopen(into, "wb") as pipe:
            try:
                pickle.dump((work(), None), pipe)
            except Exception as fault:  # noqa: BLE001 - its parent raises it
                pickle.dump((None, fault), pipe)
            except BaseException:  # noqa: BLE001 - interrupted, and so is its parent
                os._exit(1)
        os._exit(0)
    os.close(into)
    with os.fdopen(out, "rb") as pipe:
        result, problem = pickle.load(pipe)  # noqa: S301 - from a fork of this process
    os.waitpid(child, 0)
    if problem is not None:
        raise problem
    done: T = result
    return done


def reach_of(targets: Sequence[str], files: Sequence[Path], named: Sequence[Path]) -> Reach:
    """Run the tests in some files with nothing broken; return what they reach of these modules.

    `named` are those of the files that were chosen by name.

    Raises Unsound when they fail.
    """
    reach = in_a_fork(lambda: _reach(targets, files))
    reach.named = frozenset(str(file.relative_to(ROOT)) for file in named)
    for name in reach.modules:
        # No mutant is in what is not ours, and no fork need load it.
        if name.partition(".")[0] not in OURS:
            with suppress(Exception):
                importlib.import_module(name)
    return reach


def _reach(targets: Sequence[str], files: Sequence[Path]) -> Reach:
    reached = _Reached(targets)
    sys.meta_path.insert(
        0,
        _Finder(
            {
                module_of(target): partial(_Telling, target=target, show=reached.now[target].add)
                for target in targets
            }
        ),
    )
    if _status([str(file) for file in files], reached) != 0:
        raise Unsound("its tests fail with nothing broken")
    reached.found.modules, reached.found.cost_s = tuple(sys.modules), time.process_time()
    return reached.found


def tried(chosen: Sequence[Mutant], reach: Reach, jobs: int) -> tuple[list[Mutant], float]:
    """Run these mutants of one module, `jobs` at a time; return the survivors and the processor's seconds.

    Raises Unsound when the module was loaded before it could be broken.
    """
    return in_a_fork(lambda: _Campaign(chosen[0].target, reach).survivors(chosen, jobs))


class _Campaign:
    """Campaign in a process of its own: it changes the process' import system."""

    def __init__(self, target: str, reach: Reach) -> None:
        self._finder = _Finder({module_of(target): None})
        self._reach = reach
        self._names = {_once(test): test for test in reach.seconds}
        self._noticed: list[str] = []
        """The tests that have noticed a mutant, the newest first."""

    def survivors(self, chosen: Sequence[Mutant], jobs: int) -> tuple[list[Mutant], float]:
        sys.meta_path.insert(0, self._finder)
        for name in self._reach.modules:
            # The module is not found: what depends on it fails here, and each fork loads it with the mutant.
            # Tests are left to pytest.
            if not name.startswith("hil_tests"):
                with suppress(Exception):
                    importlib.import_module(name)
        if module_of(chosen[0].target) in sys.modules:
            raise Unsound("it is loaded before it is broken: nothing would notice its mutants")
        # No fork need look through, and copy, all that.
        gc.collect()
        gc.freeze()
        alive = sorted(self._run(chosen, jobs), key=lambda mutant: (mutant.node, mutant.way))
        used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
        return alive, sum(one.ru_utime + one.ru_stime for one in used)

    def _run(self, chosen: Sequence[Mutant], jobs: int) -> Iterator[Mutant]:
        running: dict[int, tuple[Mutant, int]] = {}
        for mutant in chosen:
            tests = self._reach.of(mutant)
            if not tests:
                yield mutant
                continue
            if len(running) >= jobs:
                yield from self._ended(running)
            out, into = os.pipe()
            child = os.fork()
            if not child:
                self._try(mutant, tests, into)
            os.close(into)
            running[child] = mutant, out
        while running:
            yield from self._ended(running)

    def _ended(self, running: dict[int, tuple[Mutant, int]]) -> Iterator[Mutant]:
        """Wait until one more has ended; yield it where no one noticed."""
        child, status = os.wait()
        mutant, reported = running.pop(child)
        with os.fdopen(reported, encoding="utf-8") as pipe:
            test = pipe.read()
        if os.waitstatus_to_exitcode(status) == LACKS:
            raise Unsound(f"{test}, which may notice a mutant of {mutant.target}, was not found")
        if test:
            test = self._names.get(_once(test), test)
            self._noticed = [test, *(one for one in self._noticed if one != test)]
        if status == 0:
            yield mutant

    def _try(self, mutant: Mutant, tests: Sequence[str], into: int) -> NoReturn:
        """End this process with 0 where no test notices the mutant; write into a pipe which one does."""
        # Of this process's own time: a busy machine must not look like a mutant that never ends.
        patience = 5 + PATIENCE * sum(self._reach.seconds[test] for test in tests)
        signal.setitimer(signal.ITIMER_PROF, patience)
        self._finder.loaders[module_of(mutant.target)] = partial(_Loader, mutant=mutant)
        try:
            for some in self._in_turn(tests):
                order = _Order(some, into)
                status = _status(sorted({test.partition("::")[0] for test in some}), order)
                if order.lacks:
                    os.write(into, order.lacks[0].encode())
                    os._exit(LACKS)
                if status:
                    break
        except BaseException:  # noqa: BLE001 - a mutant may fail in any way, and all of them are noticed
            status = 1
        os._exit(status)

    def _in_turn(self, tests: Sequence[str]) -> Iterator[list[str]]:
        """Yield the tests that have noticed others lately, of one file, and then all others."""
        likely = [test for test in self._noticed if test in tests] or list(tests)
        file = likely[0].partition("::")[0]
        first = [test for test in likely if test.partition("::")[0] == file][:FIRST]
        yield first
        left = [test for test in (*likely, *tests) if test not in first]
        if left:
            yield list(dict.fromkeys(left))


def _status(files: Sequence[str], *plugins: object) -> int:
    """Run the tests in some files, silently; return pytest's status."""
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    os.chdir(ROOT)
    return int(pytest.main([*QUICK, *files], plugins=plugins))
