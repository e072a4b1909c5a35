#include "shield.h"

#include <Arduino.h>
#include <Wire.h>

#include "robot.h"

// NXP, PCA9685: registers and bits.
const uint8_t MODE1 = 0x00, LED0 = 0x06, ALL_LED_OFF_H = 0xFD, PRE_SCALE = 0xFE;
const uint8_t RESTART = 0x80, AUTO_INCREMENT = 0x20, SLEEP = 0x10, ALLCALL = 0x01, FULL = 0x10;
const uint8_t CHANNELS = 16;
const uint8_t KHZ_1_5 = 3; // 25 MHz / 4096 / (3 + 1)
const uint16_t ON = 4096;
const uint8_t COUNTS = 16; // of 4096, for one of 255
const int16_t TOP = 255;
const uint32_t BUS_TIMEOUT_US = 3000; // the longest transfer takes 0.6 ms

static bool write(const uint8_t *bytes, uint8_t count) {
  Wire.beginTransmission(SHIELD_ADDRESS);
  Wire.write(bytes, count);
  return Wire.endTransmission() == 0;
}

static bool set(uint8_t reg, uint8_t value) {
  const uint8_t bytes[] = {reg, value};
  return write(bytes, sizeof bytes);
}

static bool channel(uint8_t number, uint16_t on, uint16_t off) {
  const uint8_t bytes[] = {(uint8_t)(LED0 + 4 * number), (uint8_t)on, (uint8_t)(on >> 8), (uint8_t)off,
                           (uint8_t)(off >> 8)};
  return write(bytes, sizeof bytes);
}

static bool level(uint8_t number, bool high) { return channel(number, high ? ON : 0, 0); }

void shield_begin() {
  Wire.begin();
  Wire.setWireTimeout(BUS_TIMEOUT_US, true); // a bus that hangs must not hold the auto-stop up
  set(ALL_LED_OFF_H, FULL);
  set(MODE1, 0);
  write(&MODE1, 1);
  Wire.requestFrom(SHIELD_ADDRESS, 1);
  uint8_t mode = Wire.read() & ~RESTART;
  set(MODE1, mode | SLEEP); // the prescaler can be written in sleep alone
  set(PRE_SCALE, KHZ_1_5);
  set(MODE1, mode);
  delay(5); // until the oscillator runs
  set(MODE1, RESTART | AUTO_INCREMENT | ALLCALL);
  for (uint8_t n = 0; n < CHANNELS; n++) {
    level(n, false);
  }
}

static bool drive(const Motor &motor, int16_t speed) {
  const bool back = speed < 0;
  const int16_t size = speed > TOP || speed < -TOP ? TOP : back ? -speed : speed;
  bool heard = channel(motor.pwm, 0, (uint16_t)size * COUNTS);
  // The side that was on goes off first, so that they are never on together.
  heard &= level(back || size == 0 ? motor.in1 : motor.in2, false);
  heard &= level(back || size == 0 ? motor.in2 : motor.in1, size != 0);
  return heard;
}

bool shield_drive(const int16_t speeds[]) {
  bool heard = true;
  for (uint8_t n = 0; n < MOTORS; n++) {
    heard &= drive(ROBOT[n], speeds[n]);
  }
  return heard;
}
