/* The plant's floating point as whole numbers, or no measurement: seam.py has the bounds. */
#ifndef SERVO_READINGS_H
#define SERVO_READINGS_H

#include "arithmetic.h"
#include "record.h"

static inline servo_axis *axis_at(const servo_bank *bank, int64_t k) { return ((servo_axis **)bank->axes)[k]; }

static inline int64_t refuse(servo_bank *bank, int64_t ended, int64_t axis, double value)
{
    bank->fault_axis = axis;
    bank->fault_value = value;
    return ended;
}

/* Thousandths towards zero; a value that is not finite fails the comparison, too. */
static inline bool reading(double value, int64_t *thousandths)
{
    double scaled = value * 1000.0;
    if (!(scaled >= -(double)WIDEST_READING && scaled <= (double)WIDEST_READING))
        return false;
    *thousandths = (int64_t)scaled;
    return true;
}

static inline bool counted(const servo_axis *axis, double counts, int64_t *encoder)
{
    int64_t count;
    if (!(counts >= -(double)WIDEST_ANGLE && counts <= (double)WIDEST_ANGLE))
        return false;
    count = (int64_t)counts;
    if ((double)count > counts)
        count -= 1;
    *encoder = count;
    return !beyond(count - axis->encoder, WIDEST_STEP);
}

#endif
