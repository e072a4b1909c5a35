"""Events of an axis beside its motion, every millisecond: edges at its pins, the index, a current.

Whole numbers only, as in `emulators.servo.loops`. It does not know a pin's function.
"""

from typing import Final

from emulators.servo.axis import AVERAGE_PLACES, CURRENT_REACHED, SWAPPED, ServoAxis
from emulators.servo.sensors import BROKEN, INDEX_MISSING, INDEX_SPURIOUS, SPURIOUS_PART, passed

WRAP: Final = 1 << 32
HALF: Final = 1 << 31


def notice(axis: ServoAxis) -> bool:
    """Note a passed index and changed pins; say whether one of them is watched.

    Of several indexes in one ms the last one counts; it is latched as the position at its own count,
    whichever way it was passed. Assumed: the index lies where the mounted encoder's count is a multiple of
    its turn.
    """
    raised = False
    faults = axis.sensor_faults
    if not faults & (INDEX_MISSING | BROKEN):
        raised = _pulse(axis, 0)
        if faults & INDEX_SPURIOUS:
            raised = _pulse(axis, axis.encoder_resolution // SPURIOUS_PART) or raised
    changed = axis.pins ^ axis.pins_before
    axis.pins_before = axis.pins
    return raised or changed & axis.pins_watched != 0


def _pulse(axis: ServoAxis, behind: int) -> bool:
    """Note a pulse so far behind the index, if it was passed; say whether that is watched."""
    was_passed, mark = passed(axis, behind)
    if not was_passed:
        return False
    away = mark - axis.encoder
    if bool(axis.sensor_faults & SWAPPED) != bool(axis.encoder_reversed):
        away = -away
    # INT32, as 0x6064: the latched position wraps with it.
    axis.index_position = ((axis.position + away + HALF) & (WRAP - 1)) - HALF
    axis.index_count = axis.encoder + axis.slipped + away
    axis.index_passes += 1
    return axis.index_watched != 0


def threshold(axis: ServoAxis) -> int:
    """Return whether the averaged current is beyond the watched one, where one is watched."""
    limit = axis.current_watched_ma << AVERAGE_PLACES
    current = axis.current_average
    return CURRENT_REACHED if limit and (current > limit or -current > limit) else 0
