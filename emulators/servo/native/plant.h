/* One communication step of the plant behind a bank. */
#ifndef SERVO_PLANT_H
#define SERVO_PLANT_H

#include "record.h"

/* The worst status of FMI that lets a run go on. */
#define WARNING 1

/* Inputs in, one step forward, the outputs that each tick needs out. Returns how it ended. */
int64_t servo_plant_step(servo_bank *bank, plant_calls *plant);

/* Read the first `outputs` of the outputs. Returns the FMU's status. */
int servo_plant_read(const plant_calls *plant, int64_t outputs);

#endif
