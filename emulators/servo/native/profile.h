/* The demand, one millisecond on. */
#ifndef SERVO_PROFILE_H
#define SERVO_PROFILE_H

#include "record.h"

/* Step the demands as the axis' profile says. Returns PROFILE_DONE where it has come to its end, else 0. */
int64_t servo_profile_step(servo_axis *axis);

#endif
