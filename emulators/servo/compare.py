"""Positions at which an output gives a pulse: found every millisecond, between the last count and this one.

Whole numbers only; the kernel in C does the same. Assumed: a pulse lasts whole milliseconds, for that is how
often the plant sees the outputs; its beginning and its end are events.
"""

from typing import Final

from emulators.servo.axis import ServoAxis

DOWNWARDS: Final = 1 << 0
UPWARDS: Final = 1 << 1


def compare(axis: ServoAxis) -> bool:
    """Begin or end a pulse; say whether one has begun or ended."""
    if axis.compare_left:
        axis.compare_left -= 1
        if not axis.compare_left and not _met(axis):
            return True
    if not _met(axis):
        return False
    began = not axis.compare_left
    axis.compare_left = axis.compare_pulse_ms
    axis.compare_hits += 1
    return began


def _met(axis: ServoAxis) -> bool:
    """Return True if one of the positions was passed, in a direction that counts."""
    step, after = axis.step, axis.position - axis.compare_reference
    if step == 0 or not axis.compare_direction & (UPWARDS if step > 0 else DOWNWARDS):
        return False
    # The step's end counts and its start does not: a position is met once, in either direction.
    low, high = (after - step, after) if step > 0 else (after - 1, after - step - 1)
    width = axis.compare_width
    if width <= 0:
        return low < 0 <= high
    return max(low // width + 1, axis.compare_first) <= min(high // width, axis.compare_last)
