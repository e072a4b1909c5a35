/* One communication step of a plant. */
#ifndef SERVO_PLANT_H
#define SERVO_PLANT_H

#include "record.h"

/* The worst status of FMI that lets a run go on. */
#define WARNING 1

/* Inputs in, one step forward, the first `sampled` outputs out. Returns how it ended, and FMI's `status`. */
int64_t servo_plant_step(plant_calls *plant, int64_t sampled, int64_t *status);

/* Read the first `outputs` of the outputs. Returns the FMU's status. */
int servo_plant_read(const plant_calls *plant, int64_t outputs);

#endif
