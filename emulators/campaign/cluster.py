"""Work spread over a Dask cluster; the same results as by processes of this machine."""

import re
import socket
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final, Self, TypeVar

from firmware_bridge.extras import from_extras

T = TypeVar("T")
R = TypeVar("R")

AHEAD: Final = 3
PATIENCE_S: Final = 10.0
_PLACE: Final = re.compile(r"(?:tcp|tls)://(?P<host>[^/]+):(?P<port>\d+)")


class ClusterError(Exception):
    """A cluster that cannot be used; one line."""


class Cluster:
    """The workers of a scheduler; use it in a `with`.

    ClusterError where nothing answers, or no worker is there; ExtraMissingError without the extra `cluster`.
    """

    def __init__(self, scheduler: str) -> None:
        with from_extras():
            import distributed  # noqa: PLC0415 - an extra

        # Dask's own functions carry no types.
        self._dask: Any = distributed
        _answers(scheduler)
        self._scheduler = scheduler
        self._client = self._dask.Client(scheduler, timeout=PATIENCE_S, set_as_default=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def results(self, work: Callable[[T], R], items: Sequence[T]) -> Iterator[tuple[int, R]]:
        """Yield each item's place and result, as they come; Dask gives those of a lost worker to the others.

        ClusterError where no worker is there, or one cannot do the work.
        """
        cores = sum(self._client.ncores().values())
        if not cores:
            lacks = f"it has no workers; start some: dask worker {self._scheduler}"
            raise ClusterError(f"--scheduler {self._scheduler}: {lacks}")
        waiting = iter(enumerate(items))
        places: dict[Any, int] = {}

        def submitted() -> Any:
            item = next(waiting, None)
            if item is None:
                return None
            future = self._client.submit(work, item[1], pure=False)
            places[future.key] = item[0]
            return future

        first = [future for _ in range(cores * AHEAD) if (future := submitted()) is not None]
        done = self._dask.as_completed(first, loop=self._client.loop)
        for future in done:
            try:
                result: R = future.result()
            except Exception as error:
                # The work itself ends in no error: a worker without the program, or one killed too often.
                problem = f"a worker failed: {type(error).__name__}: {error}"
                raise ClusterError(f"--scheduler {self._scheduler}: {problem}") from error
            if (another := submitted()) is not None:
                done.add(another)
            yield places.pop(future.key), result


def _answers(scheduler: str) -> None:
    """Try the scheduler's port; ClusterError. Dask's own client goes on trying when it has given up."""
    place = _PLACE.fullmatch(scheduler)
    if place is None:
        raise ClusterError(f"--scheduler '{scheduler}': it is written as tcp://HOST:PORT")
    try:
        socket.create_connection((place["host"].strip("[]"), int(place["port"])), PATIENCE_S).close()
    except (OSError, OverflowError) as error:
        raise ClusterError(
            f"--scheduler {scheduler}: nothing answers there ({error}); start one: dask scheduler"
        ) from error
