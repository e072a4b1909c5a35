/* Edges at the pins, the encoder's index, a current: signals.py says it readably. */
#include "signals.h"

#include "arithmetic.h"
#include "sensors.h"

static bool pulse(servo_axis *axis, int64_t behind)
{
    int64_t mark, away;
    if (!servo_passed(axis, behind, &mark))
        return false;
    away = mark - axis->encoder;
    if (!(axis->sensor_faults & SWAPPED) != !axis->encoder_reversed)
        away = -away;
    axis->index_position = ((axis->position + away + HALF) & (WRAP - 1)) - HALF;
    axis->index_count = axis->encoder + axis->slipped + away;
    axis->index_passes += 1;
    return axis->index_watched != 0;
}

bool servo_notice(servo_axis *axis)
{
    int64_t faults = axis->sensor_faults, changed = axis->pins ^ axis->pins_before;
    bool raised = false;
    if (!(faults & (INDEX_MISSING | BROKEN))) {
        raised = pulse(axis, 0);
        if (faults & INDEX_SPURIOUS)
            raised = pulse(axis, floor_division(axis->encoder_resolution, SPURIOUS_PART)) || raised;
    }
    axis->pins_before = axis->pins;
    return raised || (changed & axis->pins_watched) != 0;
}

int64_t servo_threshold(const servo_axis *axis)
{
    int64_t limit = shifted(axis->current_watched_ma, AVERAGE_PLACES);
    return limit && beyond(axis->current_average, limit) ? CURRENT_REACHED : 0;
}
