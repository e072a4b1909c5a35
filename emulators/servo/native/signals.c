/* Edges at the pins, the encoder's index, a current: signals.py says it readably. */
#include "signals.h"

#include "arithmetic.h"

bool servo_notice(servo_axis *axis)
{
    int64_t turn = axis->encoder_resolution, changed = axis->pins ^ axis->pins_before;
    int64_t after = floor_division(axis->encoder, turn), before = floor_division(axis->encoder - axis->step, turn);
    bool raised = false;
    if (after != before) {
        int64_t mark = (after > before ? after : after + 1) * turn;
        axis->index_position = ((axis->position + mark - axis->encoder + HALF) & (WRAP - 1)) - HALF;
        axis->index_passes += 1;
        raised = axis->index_watched != 0;
    }
    axis->pins_before = axis->pins;
    return raised || (changed & axis->pins_watched) != 0;
}

int64_t servo_threshold(const servo_axis *axis)
{
    int64_t limit = shifted(axis->current_watched_ma, AVERAGE_PLACES);
    return limit && beyond(axis->current_average, limit) ? CURRENT_REACHED : 0;
}
