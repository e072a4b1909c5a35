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

static inline int64_t servo_turns(servo_axis *axis, int64_t speed)
{
    int64_t current = axis->current_ma;
    if (axis->turning == JUST_OPENED)
        return JUST_OPENED;
    if (axis->waits) {
        axis->waits -= 1;
    } else if (axis->learning && beyond(speed, LEARNING)) {
        int64_t braking = (speed > 0 ? -current : current) - axis->left;
        int64_t lost = speed > 0 ? axis->speed_before - speed : speed - axis->speed_before;
        if (braking > 0 && SLOWING * lost <= (speed > 0 ? speed : -speed)) {
            if (braking <= axis->braking && axis->braking < 2 * braking)
                axis->learning = least(shifted(axis->learning, 1), MOST_LEARNING);
            axis->braking = braking;
            axis->raised = floor_division(braking * axis->learning, speed > 0 ? speed : -speed);
            axis->back_emf = least(axis->back_emf + axis->raised, WIDEST_BACK_EMF);
            axis->waits = SETTLING_MS;
        }
        return 1;
    }
    return axis->voltage_mv != 0 || current != 0 || beyond(axis->current_average, FADED) || beyond(speed, RESTING);
}

static inline void servo_doubt(servo_axis *axis, int64_t current, int64_t speed)
{
    int64_t before = axis->current_ma, voltage = axis->voltage_mv;
    if (axis->learning) {
        if (voltage && ((current > 0 && before <= 0 && speed > 0) || (current < 0 && before >= 0 && speed < 0))) {
            axis->back_emf = largest(0, axis->back_emf - axis->raised);
            axis->raised = least(largest(2 * axis->raised, axis->back_emf >> 10), WIDEST_BACK_EMF);
            axis->learning = largest(axis->learning >> 2, LEAST_LEARNING);
            axis->braking = 0;
            axis->waits = RECOVERING_MS;
            axis->left = least(shifted(axis->left, 1), MOST_LEFT_MA);
        }
    } else if (axis->balance_resistance && voltage && before && (voltage > 0) != (before > 0)) {
        int64_t past = before > 0 ? -current : current, size = before > 0 ? before : -before;
        if (past > (size >> 2) + DOUBTED_MA)
            axis->decay_resistance = axis->balance_resistance = 0;
    }
}

static inline int64_t servo_unfed(const servo_axis *axis, int64_t current, int64_t speed, int64_t to_come)
{
    int64_t back_emf = (axis->back_emf * largest(0, least(speed, to_come))) >> BACK_EMF_PLACES, decay_voltage;
    if (current == 0)
        return back_emf;
    if (axis->balance_resistance == 0)
        return current < 0 ? back_emf : 0;
    decay_voltage = back_emf - ((axis->decay_resistance * current) >> RESISTANCE_PLACES);
    if (current < 0 || decay_voltage <= 0)
        return decay_voltage;
    return largest(0, back_emf - ((axis->balance_resistance * current) >> RESISTANCE_PLACES));
}

static inline int64_t servo_opened(servo_axis *axis, int64_t current, int64_t speed)
{
    int64_t limit = largest(0, largest(axis->supply_mv, axis->source_mv)) + DIODES_MV, voltage, to_come;
    if (axis->turning == JUST_OPENED) {
        axis->turning = 1;
        axis->speed_before = speed;
    } else {
        servo_doubt(axis, current, speed);
    }
    to_come = 2 * speed - axis->speed_before;
    voltage = speed < 0 ? -servo_unfed(axis, -current, -speed, -to_come) : servo_unfed(axis, current, speed, to_come);
    axis->speed_before = speed;
    servo_measure(axis, current);
    axis->voltage_mv = within(voltage, limit);
    return axis->voltage_mv;
}

#endif
