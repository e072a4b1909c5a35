"""One move of the arm, no longer than the robot file allows: nothing stops it once it is sent, but a reset.

The sketch waits so many microseconds for each pulse, one joint after the other: with S in percent, and n
joints that move, 20,000 / S / n; twice as long in its first turn. The steps are shared out to its turns by
whole divisions, and each turn takes time beside its pulses.

Source: Chris-Annin/AR2, AR2_2.0, its sketch. delayMicroseconds() is right up to 16,383.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

from firmware_bridge.families.ar2 import wire
from firmware_bridge.units import MICROSECOND, Nanoseconds

FULL_US: Final = 20_000.0
"""Of all pulses of a turn together at 1 %."""
TURN_US: Final = 100.0
"""Most time of a turn beside its pulses."""
TURNS: Final = 2
"""The longest joint's steps may take so many turns each."""
LONGEST_US: Final = 15_000.0
SLACK: Final = 0.99
"""Of the time; the board rounds."""
SHORTEST_US: Final = 300.0
"""Of one pulse: a motor that gets them so fast for a while is behind by less than a step."""


class Slice(NamedTuple):
    """Steps of the six joints, ahead positive, and the speed in percent."""

    steps: tuple[int, ...]
    speed: float

    @property
    def line(self) -> bytes:
        """The line that commands it: at one speed from the begin to the end."""
        return wire.move(self.steps, self.speed)


def slice_of(wanted: Sequence[int], most: Sequence[int], within: Nanoseconds) -> Slice | None:
    """Return the move towards where joints are `wanted`, in steps from here; None where all are there.

    All joints by one share where one would do more than its `most`, or the move would last longer.
    """
    # One share for all, so that the joints keep their common way.
    share = min([1.0, *(high / abs(it) for it, high in zip(wanted, most, strict=True) if it)])
    steps = tuple(int(share * it) for it in wanted)
    lasts = within / MICROSECOND
    # Shorter pulses would lose steps: half of the way, and the rest in the next move.
    while sum(map(abs, steps)) and _left_us(steps, lasts) < SHORTEST_US * (sum(map(abs, steps)) + 6):
        steps = tuple(int(it / 2) for it in steps)
    count = sum(map(abs, steps))
    if not count:
        return None
    active = sum(1 for it in steps if it)
    # The sketch divides by the joints that step; its first turn waits twice, hence count plus active.
    pulses = min(SLACK * _left_us(steps, lasts) / (count + active) * active, LONGEST_US)
    return Slice(steps, FULL_US / pulses)


def _left_us(steps: Sequence[int], lasts: float) -> float:
    """Return how much of a time is left to the pulses."""
    return lasts - TURNS * max(map(abs, steps)) * TURN_US
