// The robot on this board: three motors, their terminals on the shield and their encoders' pins.
#pragma once

#include <stdint.h>

#ifndef AUTO_STOP_MS
#define AUTO_STOP_MS 500 // without a command for this long, the motors are released
#endif
#ifndef SHIELD_ADDRESS
#define SHIELD_ADDRESS 0x60 // 0x60 + what the jumpers A0 to A4 add
#endif

const uint8_t MOTORS = 3;

struct Motor {
  uint8_t pwm, in2, in1; // channels of the PWM chip
  uint8_t a, b;          // pins of the encoder; forwards A comes before B
};

// The terminals M1, M2 and M3. Pins 20 and 21 are I2C, so 10 and 11 have to do with pin-change interrupts.
const Motor ROBOT[MOTORS] = {
    {8, 9, 10, 2, 3},
    {13, 12, 11, 18, 19},
    {2, 3, 4, 10, 11},
};

const uint8_t SERIAL_AND_I2C[] = {0, 1, 20, 21};
