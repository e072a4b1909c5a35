"""Work spread over processes of this machine: a process that dies is replaced, and its items done again."""

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context, parent_process
from multiprocessing.process import BaseProcess
from typing import Final, TypeVar

T = TypeVar("T")
R = TypeVar("R")

TRIES: Final = 3
"""Processes that an item may be in as they die."""
AHEAD: Final = 3
"""Items that wait for each process: none waits for the next one, and few are lost with one."""


class SpreadError(Exception):
    """An item whose process dies again and again."""


def spread(work: Callable[[T], R], items: Sequence[T], jobs: int) -> Iterator[tuple[int, R]]:
    """Yield each item's place and result, as they come.

    `work` is a function that can be sent to a process; what it raises is raised here. SpreadError where a
    process has died `TRIES` times around an item.
    """
    if jobs <= 1 or len(items) <= 1:
        yield from ((place, work(item)) for place, item in enumerate(items))
        return
    left, deaths = dict(enumerate(items)), dict.fromkeys(range(len(items)), 0)
    while left:
        with _processes(min(jobs, len(left))) as pool:
            try:
                for place, result in _through(pool, work, left, jobs * AHEAD):
                    del left[place]
                    yield place, result
            except _DiedError as died:
                for place in died.places:
                    deaths[place] += 1
                    if deaths[place] >= TRIES:
                        raise SpreadError(
                            f"item {place}: its process has died {TRIES} times; is there memory left?"
                        ) from None
            except BaseException:
                # Who stops in the middle waits for what runs, and for nothing behind it.
                pool.shutdown(wait=False, cancel_futures=True)
                raise


def in_order(work: Callable[[T], R], items: Sequence[T], jobs: int) -> Iterator[R]:
    """Yield the results in the order of the items, each as soon as those before it are there."""
    early: dict[int, R] = {}
    due = 0
    for place, result in spread(work, items, jobs):
        early[place] = result
        while due in early:
            yield early.pop(due)
            due += 1


class _DiedError(Exception):
    def __init__(self, places: Sequence[int]) -> None:
        super().__init__(places)
        self.places = places


def _processes(jobs: int) -> ProcessPoolExecutor:
    # Forks would share what a plant's library keeps; a new process has its own.
    return ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_begins)


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
