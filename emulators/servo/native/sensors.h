/* The sensors of an axis, their wires, and what is noticed when they fail. */
#ifndef SERVO_SENSORS_H
#define SERVO_SENSORS_H

#include <stdbool.h>

#include "record.h"

/* Returns what the drive counts of a step of the shaft. */
int64_t servo_counted(servo_axis *axis, int64_t turned);

/* Returns whether a pulse `behind` the index was passed in this ms, and sets the shaft's count there. */
bool servo_passed(const servo_axis *axis, int64_t behind, int64_t *mark);

/* Returns the flags of what is wrong with the sensors. */
int64_t servo_supervise(servo_axis *axis);

#endif
