/* The sin2 profile: sine.py says it readably. */
#ifndef SERVO_SINE_H
#define SERVO_SINE_H

#include "arithmetic.h"
#include "record.h"

static inline int64_t share(int64_t part)
{
    int64_t square = (part * part) >> SHARE_PLACES, rest = SINE_7;
    rest = SINE_6 - ((rest * square) >> SHARE_PLACES);
    rest = SINE_5 - ((rest * square) >> SHARE_PLACES);
    rest = SINE_4 - ((rest * square) >> SHARE_PLACES);
    rest = SINE_3 - ((rest * square) >> SHARE_PLACES);
    rest = SINE_2 - ((rest * square) >> SHARE_PLACES);
    rest = SINE_1 - ((rest * square) >> SHARE_PLACES);
    return (rest * square) >> SHARE_PLACES;
}

static inline int64_t risen(int64_t change, int64_t at, int64_t length)
{
    return (change * share(shifted(at, SHARE_PLACES) / length)) >> SHARE_PLACES;
}

static inline void next_leg(servo_axis *axis)
{
    axis->leg_from = axis->leg_to;
    axis->leg_to = axis->leg_2_to;
    axis->leg_ms = axis->leg_2_ms;
    axis->leg_2_to = axis->leg_3_to;
    axis->leg_2_ms = axis->leg_3_ms;
    axis->leg_3_to = axis->leg_4_to;
    axis->leg_3_ms = axis->leg_4_ms;
    axis->leg_4_ms = 0;
    axis->leg_at = 0;
}

static inline bool servo_legs(servo_axis *axis)
{
    int64_t at, length, change, following;
    if (axis->leg_at == axis->leg_ms && axis->leg_2_ms)
        next_leg(axis);
    if (axis->leg_at < axis->leg_ms)
        axis->leg_at += 1;
    at = axis->leg_at;
    length = axis->leg_ms;
    change = axis->leg_to - axis->leg_from;
    if (at == length || change == 0)
        following = axis->leg_to;
    else if (2 * at < length)
        following = axis->leg_from + risen(change, at, length);
    else
        following = axis->leg_to - risen(change, length - at, length);
    if (axis->leg_spare > 0) {
        axis->leg_spare -= 1;
        following += 1;
    } else if (axis->leg_spare < 0) {
        axis->leg_spare += 1;
        following -= 1;
    }
    axis->acceleration_demand = following - axis->velocity_demand;
    axis->velocity_demand = following;
    axis->position_demand += following;
    if (at != length || axis->leg_2_ms != 0)
        return false;
    return axis->profile != MOVE || axis->position_demand == axis->target_position;
}

#endif
