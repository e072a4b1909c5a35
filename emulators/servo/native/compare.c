/* Positions at which an output gives a pulse: compare.py says it readably. */
#include "compare.h"

#include "arithmetic.h"

static bool met(const servo_axis *axis)
{
    int64_t step = axis->step, after = axis->position - axis->compare_reference, width = axis->compare_width;
    int64_t low = step > 0 ? after - step : after - 1, high = step > 0 ? after : after - step - 1;
    if (step == 0 || !(axis->compare_direction & (step > 0 ? UPWARDS : DOWNWARDS)))
        return false;
    if (width <= 0)
        return low < 0 && 0 <= high;
    return largest(floor_division(low, width) + 1, axis->compare_first)
        <= least(floor_division(high, width), axis->compare_last);
}

bool servo_compare(servo_axis *axis)
{
    bool began;
    if (axis->compare_left) {
        axis->compare_left -= 1;
        if (!axis->compare_left && !met(axis))
            return true;
    }
    if (!met(axis))
        return false;
    began = !axis->compare_left;
    axis->compare_left = axis->compare_pulse_ms;
    axis->compare_hits += 1;
    return began;
}
