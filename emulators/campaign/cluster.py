"""Work spread over a Dask cluster; the same results as by processes of this machine."""

import re
import socket
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final, TypeVar

from firmware_bridge.extras import from_extras

T = TypeVar("T")
R = TypeVar("R")

AHEAD: Final = 3
PATIENCE_S: Final = 10.0
_PLACE: Final = re.compile(r"(?:tcp|tls)://(?P<host>[^/]+):(?P<port>\d+)")


class ClusterError(Exception):
    """A cluster that cannot be used; one line."""


def on_cluster(scheduler: str, work: Callable[[T], R], items: Sequence[T]) -> Iterator[tuple[int, R]]:
    """Yield each item's place and result, as they come, from the workers of a scheduler at tcp://HOST:PORT.

    Dask gives the items of a worker that is gone to the others. ClusterError where nothing answers, or no
    worker is there; ExtraMissingError without the extra `cluster`.
    """
    with from_extras():
        import distributed  # noqa: PLC0415 - an extra

    # Dask's own functions carry no types.
    dask: Any = distributed

    _answers(scheduler)
    client = dask.Client(scheduler, timeout=PATIENCE_S, set_as_default=False)
    with client:
        cores = sum(client.ncores().values())
        if not cores:
            raise ClusterError(
                f"--scheduler {scheduler}: it has no workers; start some: dask worker {scheduler}"
            )
        waiting = iter(enumerate(items))
        places: dict[Any, int] = {}

        def submitted() -> Any:
            item = next(waiting, None)
            if item is None:
                return None
            future = client.submit(work, item[1], pure=False)
            places[future.key] = item[0]
            return future

        first = [future for _ in range(cores * AHEAD) if (future := submitted()) is not None]
        done = dask.as_completed(first, loop=client.loop)
        for future in done:
            result: R = future.result()
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
