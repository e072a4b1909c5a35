"""A fixed loop of plain Python: its time is the measure of a machine, by which figures of others are scaled.

Usage: python -m benchmarks.reference

It must never change: what was measured beside it would have no scale. It is interpreted on purpose, also
where the core is compiled.
"""

from typing import Final

from benchmarks.measure import fastest

ROUNDS: Final = 120_000
REPEATS: Final = 7
KEPT_MS: Final = 24.0
"""Its time in ms on the kind of machine on which the goals of `benchmarks.parts` were set.

Measured on 2026-11-28 on two quiet cores; not in the minute in which the goals were set.
"""


class Cell:
    """A number that is stepped on: attributes and a call, as in a node."""

    def __init__(self, value: float) -> None:
        self.value = value

    def step(self, by: float) -> float:
        """Return the next value."""
        self.value = self.value * 0.5 + by
        return self.value


def loop() -> float:
    """Run the loop: calls, attributes, a dict, a list, bytes, floats and whole numbers."""
    cells = [Cell(float(place)) for place in range(8)]
    counts: dict[int, int] = {}
    total = 0.0
    for place in range(ROUNDS):
        total += cells[place & 7].step(place * 1e-3)
        counts[place & 63] = counts.get(place & 63, 0) + 1
        if not place & 15:
            frame = place.to_bytes(8, "little")
            total += frame[0] + int.from_bytes(frame[:4], "little") % 7
    return total + len(counts)


def loop_ms() -> float:
    """Return the shortest time of some runs of the loop in ms."""
    return 1e3 * fastest(loop, REPEATS)


if __name__ == "__main__":
    print(f"{loop_ms():.2f} ms")
