/* The spline of interpolated position mode: spline.py says it readably. */
#ifndef SERVO_SPLINE_H
#define SERVO_SPLINE_H

#include "arithmetic.h"
#include "record.h"

static inline bool servo_spline(servo_axis *axis)
{
    int64_t length = axis->spline_ms, at, gone, position, speed;
    if (length == 0) {
        axis->acceleration_demand = -axis->velocity_demand;
        axis->velocity_demand = 0;
        return true;
    }
    axis->spline_at += 1;
    at = axis->spline_at;
    gone = axis->spline_square + floor_division(axis->spline_cube * at, length);
    gone = axis->spline_linear + floor_division(gone * at, length);
    position = axis->knot + floor_division(gone * at, length);
    speed = position - axis->position_demand;
    axis->acceleration_demand = speed - axis->velocity_demand;
    axis->velocity_demand = speed;
    axis->position_demand = position;
    if (at == length) {
        axis->knot = position;
        axis->spline_at = 0;
        axis->spline_linear = axis->next_linear;
        axis->spline_square = axis->next_square;
        axis->spline_cube = axis->next_cube;
        axis->spline_ms = axis->next_ms;
        axis->next_ms = 0;
        axis->splines_done += 1;
        axis->call = 1;
    }
    return false;
}

#endif
