"""Cost of keeping a moment of a run and of restoring it, against driving on for ten milliseconds.

Each is the least of many on one and the same moment, in the processor's time.
"""

from collections.abc import Callable, Iterator
from time import thread_time
from typing import Final

from benchmarks.figure import Figure
from benchmarks.watches import rig_and_operator
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

AT: Final[tuple[Nanoseconds, ...]] = (5 * SECOND, 20 * SECOND)
"""Early and late: what a run has gathered must not make its moments dearer."""
STEP: Final[Nanoseconds] = 10 * MILLISECOND
REPEATS: Final = 100


def least(times: list[float]) -> float:
    """Return the shortest in milliseconds."""
    return 1e3 * min(times)


def figures() -> Iterator[Figure]:
    """Measure early and late."""
    rig, _ = rig_and_operator()
    for at in AT:
        rig.run(at)
        moment = rig.snapshot()
        there: list[float] = []
        back: list[float] = []
        on: list[float] = []

        def timed(times: list[float], call: Callable[[], object]) -> None:
            begun = thread_time()
            call()
            times.append(thread_time() - begun)

        for _ in range(REPEATS):
            timed(back, lambda moment=moment: rig.restore(moment))  # type: ignore[misc] # bound now
            timed(on, lambda at=at: rig.run(at + STEP))  # type: ignore[misc] # bound now
            timed(there, rig.snapshot)
        for name, times in (("kept", there), ("put back", back)):
            yield Figure(
                name=f"a moment {name}, at {at / SECOND:g} s",
                value=least(times),
                unit="ms",
                against="10 ms driven",
                reference=least(on),
            )
    rig.finish()
