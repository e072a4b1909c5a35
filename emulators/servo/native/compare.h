/* Positions at which an output gives a pulse. */
#ifndef SERVO_COMPARE_H
#define SERVO_COMPARE_H

#include <stdbool.h>

#include "record.h"

/* Begin or end a pulse. Returns whether one has begun or ended. */
bool servo_compare(servo_axis *axis);

#endif
