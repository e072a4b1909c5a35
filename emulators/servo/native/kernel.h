/* The servo kernel: all axes of a bank and their plant, from one event to the next.

   Whole numbers only, as in the reference (emulators/servo/reference.py, loops.py, profile.py, winding.py), which says
   same readably: a change here is a change there. Floating point only where the plant is met. */
#ifndef SERVO_KERNEL_H
#define SERVO_KERNEL_H

#include "record.h"

#ifdef _WIN32
#define SERVO_EXPORT __declspec(dllexport)
#else
#define SERVO_EXPORT __attribute__((visibility("default")))
#endif

/* What the library was built from: the first 64 bits of its sources' SHA-256. */
SERVO_EXPORT uint64_t servo_source(void);

/* Run ticks up to number `last`, or to the end of the first one with an event. Returns how it ended. */
SERVO_EXPORT int64_t servo_run(servo_bank *bank, int64_t last);

/* Turn a shield's motors up to tick `last`: emulators/arduino_omni/motors.py is the reference. Returns how it ended. */
SERVO_EXPORT int64_t servo_turn(servo_terminals *motors, int64_t last);

/* The same millisecond as the reference's: for tests of one axis without a plant. Returns whether it raised an event. */
SERVO_EXPORT int64_t servo_millisecond(servo_axis *axis, int64_t encoder);

#endif
