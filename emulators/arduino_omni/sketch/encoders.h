// Where the motors are, in quarters of an encoder's line.
#pragma once

#include <stdint.h>

void encoders_begin();
int32_t encoder_count(uint8_t motor);
void encoders_clear();
