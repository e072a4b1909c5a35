"""Cost of keeping a moment of a run and of restoring it, against driving on for ten milliseconds.

Usage: python -m benchmarks.moments

Each is the least of many on one and the same moment, in the processor's time.
"""

from collections.abc import Callable
from time import thread_time
from typing import Final

from benchmarks.measure import show
from benchmarks.realtime import rig_and_operator
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

AT: Final[tuple[Nanoseconds, ...]] = (5 * SECOND, 20 * SECOND)
"""Early and late: what a run has gathered must not make its moments dearer."""
STEP: Final[Nanoseconds] = 10 * MILLISECOND
REPEATS: Final = 100


def least(times: list[float]) -> float:
    """Return the shortest in milliseconds."""
    return 1e3 * min(times)


def main() -> None:
    """Measure and print."""
    rig, _ = rig_and_operator()
    rows = []
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
        drive = least(on)
        figures = [(name, least(times)) for name, times in (("kept", there), ("put back", back))]
        rows += [
            (f"{name} at {at / SECOND:g} s", f"{spent:.2f} ms", f"{spent / drive:.2f}")
            for name, spent in figures
        ]
    show("moments of a run", ("moment", "least", "of 10 ms driven"), rows)


if __name__ == "__main__":
    main()
