"""Work spread over processes of this machine: a process that dies is replaced, and its items done again."""

import os
import signal
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context, parent_process
from multiprocessing.process import BaseProcess
from typing import Final, Self, TypeVar

T = TypeVar("T")
R = TypeVar("R")

TRIES: Final = 3
"""Processes that an item may be in as they die."""
AHEAD: Final = 3
"""Items that wait for each process: none waits for the next one, and few are lost with one."""


class SpreadError(Exception):
    """An item whose process dies again and again."""


class Processes:
    """Processes that take work until they are left; use it in a `with`. None where one job is enough."""

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            # Who stops in the middle waits for what runs, and for nothing behind it.
            self._pool.shutdown(wait=True, cancel_futures=True)

    def results(self, work: Callable[[T], R], items: Sequence[T]) -> Iterator[tuple[int, R]]:
        """Yield each item's place and result, as they come; see `spread`."""
        _can_be_sent(work)
        if self._jobs <= 1:
            yield from ((place, work(item)) for place, item in enumerate(items))
            return
        left, deaths = dict(enumerate(items)), Counter[int]()
        while left:
            pool = self._started()
            try:
                for place, result in _through(pool, work, left, self._jobs * AHEAD):
                    del left[place]
                    yield place, result
            except _DiedError as died:
                pool.shutdown(wait=False)
                self._pool = None
                # One that dies before it has an item counts for the first that waits.
                deaths.update(died.places or (next(iter(left)),))
                worst, count = deaths.most_common(1)[0]
                if count >= TRIES:
                    raise SpreadError(
                        f"item {worst}: its process has died {TRIES} times; is there memory left?"
                    ) from None

    def _started(self) -> ProcessPoolExecutor:
        if self._pool is None:
            # Forks would share what a plant's library keeps; a new process has its own.
            self._pool = ProcessPoolExecutor(self._jobs, mp_context=get_context("spawn"), initializer=_begins)
        return self._pool


def spread(work: Callable[[T], R], items: Sequence[T], jobs: int) -> Iterator[tuple[int, R]]:
    """Yield each item's place and result, as they come.

    `work` is a function that can be sent to a process; what it raises is raised here. SpreadError where a
    process has died `TRIES` times around an item.
    """
    with Processes(min(jobs, len(items))) as processes:
        yield from processes.results(work, items)


def in_order(work: Callable[[T], R], items: Sequence[T], jobs: int) -> Iterator[R]:
    """Yield the results in the order of the items, each as soon as those before it are there."""
    early: dict[int, R] = {}
    due = 0
    for place, result in spread(work, items, jobs):
        early[place] = result
        while due in early:
            yield early.pop(due)
            due += 1


def _can_be_sent(work: Callable[..., object]) -> None:
    """Raise ValueError for a function of a package's `__main__`: a new process does not import that."""
    function = work.func if isinstance(work, partial) else work
    of = getattr(sys.modules["__main__"], "__spec__", None)
    if function.__module__ == "__main__" and of is not None and of.name.endswith(".__main__"):
        raise ValueError(f"{function.__qualname__}: move it from {of.name} into a module of its own")


class _DiedError(Exception):
    def __init__(self, places: Sequence[int]) -> None:
        super().__init__(places)
        self.places = places


def _begins() -> None:
    """End with the process that began this one; leave Ctrl-C to it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_ends_with, args=(parent_process(),), daemon=True).start()


def _ends_with(above: BaseProcess | None) -> None:
    if above is not None:
        above.join()
        os._exit(1)


def _through(
    pool: ProcessPoolExecutor, work: Callable[[T], R], left: dict[int, T], ahead: int
) -> Iterator[tuple[int, R]]:
    waiting = iter(list(left.items()))
    running: dict[Future[R], int] = {}
    while True:
        try:
            while len(running) < ahead and (item := next(waiting, None)) is not None:
                running[pool.submit(work, item[1])] = item[0]
            if not running:
                return
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                result = future.result()
                yield running.pop(future), result
        except BrokenProcessPool:
            raise _DiedError(list(running.values())) from None
