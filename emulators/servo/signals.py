"""What an axis notices beside its motion every millisecond: edges at its pins, the index, a current.

Whole numbers only, as in `emulators.servo.loops`. It refuses to know what a pin is for.
"""

from typing import Final

from emulators.servo.axis import AVERAGE_PLACES, CURRENT_REACHED, ServoAxis

WRAP: Final = 1 << 32
HALF: Final = 1 << 31


def notice(axis: ServoAxis) -> bool:
    """Note a passed index and changed pins; say whether one of them is watched.

    Of several indexes in one ms the last one counts; it is latched as the position at its own count,
    whichever way it was passed. ASSUME: the index lies where the mounted encoder's count is a multiple of
    its turn.
    """
    turn, after = axis.encoder_resolution, axis.encoder // axis.encoder_resolution
    before = (axis.encoder - axis.step) // turn
    raised = False
    if after != before:
        mark = (after if after > before else after + 1) * turn
        axis.index_position = ((axis.position + mark - axis.encoder + HALF) & (WRAP - 1)) - HALF
        axis.index_passes += 1
        raised = axis.index_watched != 0
    changed = axis.pins ^ axis.pins_before
    axis.pins_before = axis.pins
    return raised or changed & axis.pins_watched != 0


def threshold(axis: ServoAxis) -> int:
    """Tell whether the averaged current is beyond the watched one, where one is watched."""
    limit = axis.current_watched_ma << AVERAGE_PLACES
    current = axis.current_average
    return CURRENT_REACHED if limit and (current > limit or -current > limit) else 0
