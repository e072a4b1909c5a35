/* What an axis notices beside its motion. */
#ifndef SERVO_SIGNALS_H
#define SERVO_SIGNALS_H

#include <stdbool.h>

#include "record.h"

/* Note the index that was passed and the pins that changed. Returns whether one of them is watched. */
bool servo_notice(servo_axis *axis);

/* Returns CURRENT_REACHED where the averaged current is beyond the watched one, else 0. */
int64_t servo_threshold(const servo_axis *axis);

#endif
