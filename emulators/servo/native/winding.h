/* What a winding does every tick: winding.py says it readably. In a header, because every tick runs through it. */
#ifndef SERVO_WINDING_H
#define SERVO_WINDING_H

#include "arithmetic.h"
#include "record.h"

static inline void servo_measure(servo_axis *axis, int64_t current)
{
    axis->current_ma = current;
    axis->current_average += (shifted(current, AVERAGE_PLACES) - axis->current_average) >> AVERAGE;
}

static inline int64_t servo_regulate(servo_axis *axis, int64_t current)
{
    int64_t error = axis->current_demand_ma - current;
    int64_t integral = axis->current_integral + axis->current_i * error;
    int64_t voltage = (axis->current_p * error + integral) >> CURRENT_PLACES;
    int64_t limit = floor_division(axis->supply_mv * axis->voltage_percent, 100);
    servo_measure(axis, current);
    if (-limit <= voltage && voltage <= limit) {
        axis->current_integral = integral;
    } else {
        voltage = voltage > 0 ? limit : -limit;
        if ((integral > axis->current_integral) != (voltage > 0))
            axis->current_integral = integral;
    }
    axis->voltage_mv = voltage;
    return voltage;
}

static inline bool servo_turns(servo_axis *axis, int64_t speed)
{
    int64_t current = axis->current_ma;
    if (beyond(speed, LEARNING)) {
        int64_t constant = axis->back_emf;
        if (constant == 0)
            constant = largest(0, floor_division(shifted(axis->voltage_mv, BACK_EMF_PLACES), speed));
        if (beyond(current, 1))
            constant = largest(0, constant + floor_division(-(current * LEARNING_RATE), speed));
        axis->back_emf = least(constant, WIDEST_BACK_EMF);
        return true;
    }
    return axis->voltage_mv != 0 || current != 0 || beyond(axis->current_average, FADED) || beyond(speed, RESTING);
}

static inline int64_t servo_opened(servo_axis *axis, int64_t current, int64_t speed)
{
    int64_t voltage = axis->voltage_mv;
    if (!beyond(speed, RESTING))
        voltage = 0;
    else if (axis->back_emf)
        voltage = (axis->back_emf * speed + ((int64_t)1 << BACK_EMF_PLACES >> 1)) >> BACK_EMF_PLACES;
    servo_measure(axis, current);
    axis->voltage_mv = voltage;
    return voltage;
}

#endif
