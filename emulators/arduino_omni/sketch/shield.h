// The motor shield: what goes over I2C to its PWM chip, a PCA9685, and so to the half bridges.
#pragma once

#include <stdint.h>

// Release all motors, and then set the chip up. The chip has no wire to RESET: it may be driving them.
void shield_begin();

// -255 to 255 for each motor; 0 lets it coast. Whether the chip has acknowledged all of it.
bool shield_drive(const int16_t speeds[]);
