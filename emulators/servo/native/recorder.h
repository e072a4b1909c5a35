/* Records fields of an axis into a ring. */
#ifndef SERVO_RECORDER_H
#define SERVO_RECORDER_H

#include "record.h"

/* Run one tick of an axis that is recorded. */
void servo_record(servo_axis *axis, servo_recorder *recorder);

#endif
