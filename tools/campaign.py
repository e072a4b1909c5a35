# ruff: noqa: INP001 - a script's neighbour, not a package
"""One module's mutants, each against the module's tests, in a fork of a process that has loaded the rest.

It refuses to know which modules are tried, and which mutants may survive.
"""

import gc
import importlib.abc
import importlib.machinery
import os
import pickle
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from types import CodeType, FrameType, ModuleType
from typing import Any, Final, NoReturn, TypeVar

import pytest
from mutants import ROOT, Mutant, module_of, path_of

T = TypeVar("T")

TIMEOUT_S: Final = 30
QUICK: Final = (
    *("-x", "-q", "--tb=no", "--assert=plain", f"--rootdir={ROOT}"),
    *(f"-pno:{name}" for name in ("cacheprovider", "xdist", "hypothesispytest", "unraisableexception")),
)
"""Nobody reads what pytest says: what makes its failures readable would take most of a run's time."""


class Unsound(Exception):  # noqa: N818 - of the campaign, not of a call
    """What the tests said of the mutants is worth nothing, and why."""


class _Loader(importlib.machinery.SourceFileLoader):
    """Loads the mutant in place of the module."""

    def __init__(self, name: str, mutant: Mutant) -> None:
        super().__init__(name, str(path_of(mutant.target)))
        self._mutant = mutant

    def get_code(self, fullname: str) -> CodeType:
        del fullname
        return compile(self._mutant.tree(), self.path, "exec")


class _Finder(importlib.abc.MetaPathFinder):
    """Finds the mutant before the module; until there is one, nobody finds the module."""

    def __init__(self, name: str) -> None:
        self._name = name
        self.mutant: Mutant | None = None

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        del path, target
        if fullname != self._name:
            return None
        if self.mutant is None:
            raise ImportError(fullname)
        loader = _Loader(fullname, self.mutant)
        return importlib.machinery.ModuleSpec(fullname, loader, origin=loader.path)


class _Reached:
    """Pytest's plugin that notes which lines of a file each test reaches."""

    def __init__(self, file: str) -> None:
        self._file = file
        self._lines: set[int] = set()
        self.lines: dict[str, set[int]] = {}

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self._lines = self.lines[item.nodeid] = set()
        sys.settrace(self._called)
        yield
        sys.settrace(None)

    def _called(self, frame: FrameType, _event: str, _argument: object) -> Any:
        return self._line if frame.f_code.co_filename == self._file else None

    def _line(self, frame: FrameType, _event: str, _argument: object) -> Any:
        self._lines.add(frame.f_lineno)
        return self._line


class _Order:
    """Pytest's plugin that runs some tests first, in their order, and writes down which one fails."""

    def __init__(self, first: Sequence[str], into: int) -> None:
        self._rank = {test: place for place, test in enumerate(first)}
        self._into = into

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items.sort(key=lambda item: self._rank.get(item.nodeid, len(self._rank)))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            os.write(self._into, report.nodeid.encode())


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
        os._exit(0)
    os.close(into)
    with os.fdopen(out, "rb") as pipe:
        result, problem = pickle.load(pipe)  # noqa: S301 - from a fork of this process
    os.waitpid(child, 0)
    if problem is not None:
        raise problem
    done: T = result
    return done


def tried(target: str, tests: Sequence[str], chosen: Sequence[Mutant], jobs: int) -> list[Mutant]:
    """Run these mutants of one module, `jobs` at a time, with tests below `hil_tests`; return the survivors.

    Raises Unsound when the tests fail with nothing broken, before or after.
    """
    return in_a_fork(lambda: _Campaign(target, tests).survivors(chosen, jobs))


class _Campaign:
    """It changes what its process finds where modules are looked for: it has one of its own."""

    def __init__(self, target: str, tests: Sequence[str]) -> None:
        self._target = target
        self._tests = [str(ROOT / "hil_tests" / test) for test in tests]
        self._finder = _Finder(module_of(target))
        self._reached: dict[str, set[int]] = {}
        """The lines that each test reaches."""
        self._noticed: list[str] = []
        """The tests that have noticed a mutant, the newest first."""

    def survivors(self, chosen: Sequence[Mutant], jobs: int) -> list[Mutant]:
        self._reached, modules = in_a_fork(self._loaded)
        sys.meta_path.insert(0, self._finder)
        for name in modules:
            # The module is not found: what depends on it fails here, and each fork loads it with the mutant.
            # Tests are left to pytest.
            if not name.startswith("hil_tests"):
                with suppress(Exception):
                    importlib.import_module(name)
        if module_of(self._target) in sys.modules:
            raise Unsound("it is loaded before it is broken: nothing would notice its mutants")
        # No fork need look through, and copy, all that.
        gc.collect()
        gc.freeze()
        alive = sorted(self._run(chosen, jobs), key=lambda mutant: mutant.node)
        # A tree that changed meanwhile would let every test fail, and every mutant look noticed.
        sys.meta_path.remove(self._finder)
        if in_a_fork(self._status) != 0:
            raise Unsound("its tests fail after the campaign, with nothing broken")
        return alive

    def _loaded(self) -> tuple[dict[str, set[int]], list[str]]:
        """Run the tests with nothing broken; return what they reach, and all modules that are then loaded."""
        reached = _Reached(str(path_of(self._target)))
        if self._status(reached) != 0:
            raise Unsound("its tests fail before the campaign, with nothing broken")
        return reached.lines, list(sys.modules)

    def _run(self, chosen: Sequence[Mutant], jobs: int) -> Iterator[Mutant]:
        running: dict[int, tuple[Mutant, int]] = {}

        def ended() -> Iterator[Mutant]:
            child, status = os.wait()
            mutant, told = running.pop(child)
            with os.fdopen(told, encoding="utf-8") as pipe:
                test = pipe.read()
            if test:
                self._noticed = [test, *(one for one in self._noticed if one != test)]
            if status == 0:
                yield mutant

        for mutant in chosen:
            if len(running) >= jobs:
                yield from ended()
            out, into = os.pipe()
            child = os.fork()
            if not child:
                self._try(mutant, into)
            os.close(into)
            running[child] = mutant, out
        while running:
            yield from ended()

    def _try(self, mutant: Mutant, into: int) -> NoReturn:
        """End this process with 0 where no test notices the mutant; write into a pipe which one does."""
        # Of this process's own time: a busy machine must not look like a mutant that never ends.
        signal.setitimer(signal.ITIMER_PROF, TIMEOUT_S)
        self._finder.mutant = mutant
        try:
            status = self._status(_Order(self._likely(mutant), into))
        except BaseException:  # noqa: BLE001 - a mutant may fail in any way, and all of them are noticed
            status = 1
        os._exit(status)

    def _likely(self, mutant: Mutant) -> list[str]:
        """Return the tests in the order in which they are likely to notice a mutant.

        Those that reach its line come first, among them those that noticed others.
        """
        tests = (*self._noticed, *(test for test in self._reached if test not in self._noticed))
        return sorted(tests, key=lambda test: mutant.line not in self._reached.get(test, ()))

    def _status(self, *plugins: object) -> int:
        """Run the tests, silently; return pytest's status."""
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        return int(pytest.main([*QUICK, *self._tests], plugins=plugins))
