/* Following the digital position input, and analogue set-points: electronic_gear.py and setpoint.py say it readably. */
#ifndef SERVO_ELECTRONIC_GEAR_H
#define SERVO_ELECTRONIC_GEAR_H

#include "arithmetic.h"
#include "record.h"

static inline int64_t between(int64_t low, int64_t value, int64_t high) { return largest(low, least(high, value)); }

static inline int64_t closing_speed(const servo_axis *axis, int64_t behind)
{
    int64_t way = behind >= 0 ? behind : -behind, slowing = axis->deceleration, speed;
    if (way >= axis->stopping_distance)
        speed = axis->cruise;
    else if (way <= slowing)
        speed = way;
    else
        speed = (whole_root(8 * slowing * way + slowing * slowing) - slowing) >> 1;
    return behind >= 0 ? speed : -speed;
}

static inline bool servo_electronic_gear(servo_axis *axis)
{
    int64_t steps = within(axis->master - axis->gear_counted, FASTEST_INPUT);
    int64_t counted = axis->gear_rest + steps * axis->gear_numerator;
    int64_t whole = floor_division(counted, axis->gear_denominator);
    int64_t before = between(axis->lowest, axis->target_position, axis->highest);
    int64_t speed = axis->velocity_demand, ahead, target, wanted, following;
    axis->gear_counted = axis->master;
    axis->gear_rest = counted - whole * axis->gear_denominator;
    axis->target_position += shifted(within(whole, FASTEST_INPUT >> axis->fraction), axis->fraction);
    target = between(axis->lowest, axis->target_position, axis->highest);
    ahead = target - before;
    wanted = within(ahead + closing_speed(axis, before - axis->position_demand), axis->cruise);
    following = between(speed - axis->deceleration, wanted, speed + axis->acceleration);
    axis->acceleration_demand = following - speed;
    axis->velocity_demand = following;
    axis->position_demand += following;
    return axis->position_demand == target;
}

static inline void servo_setpoint(servo_axis *axis)
{
    int64_t millivolts = within(axis->analogue_input == 1 ? axis->analogue_1_mv : axis->analogue_2_mv, WIDEST_VOLTAGE);
    int64_t value = floor_division(millivolts * axis->analogue_numerator, axis->analogue_denominator);
    value = within(value + axis->analogue_offset, WIDEST_SETPOINT);
    if (axis->regulator == CURRENT) {
        axis->current_setting_ma = value;
    } else if (axis->regulator == VELOCITY) {
        int64_t units = shifted(2 * within(value, FASTEST_RPM) * axis->resolution, axis->fraction);
        units = floor_division(units + MILLISECONDS_PER_MINUTE, 2 * MILLISECONDS_PER_MINUTE);
        axis->velocity_demand = axis->target_velocity = within(units, axis->cruise);
    } else {
        axis->target_position = between(axis->lowest, shifted(value, axis->fraction), axis->highest);
        axis->position_demand = axis->target_position;
        axis->velocity_demand = 0;
    }
}

#endif
