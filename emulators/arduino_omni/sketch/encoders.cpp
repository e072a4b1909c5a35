#include "encoders.h"

#include <Arduino.h>
#include <util/atomic.h>

#include "robot.h"

struct Encoder {
  volatile uint8_t *port_a, *port_b;
  uint8_t bit_a, bit_b;
  uint8_t before; // levels of A and B
  int32_t count;
};

static Encoder encoders[MOTORS];

// By the levels before and now, AB AB. Where both have changed an edge was lost, and nothing can be said.
static const int8_t STEPS[16] = {0, -1, 1, 0, 1, 0, 0, -1, -1, 0, 0, 1, 0, 1, -1, 0};

static inline uint8_t levels(const Encoder &it) {
  return (*it.port_a & it.bit_a ? 2 : 0) | (*it.port_b & it.bit_b ? 1 : 0);
}

static inline void moved(Encoder &it) {
  uint8_t now = levels(it);
  it.count += STEPS[it.before << 2 | now];
  it.before = now;
}

static void first() { moved(encoders[0]); }
static void second() { moved(encoders[1]); }

ISR(PCINT0_vect) { moved(encoders[2]); } // pins 10 to 13, and 50 to 53

void encoders_begin() {
  for (uint8_t n = 0; n < MOTORS; n++) {
    Encoder &it = encoders[n];
    const Motor &motor = ROBOT[n];
    pinMode(motor.a, INPUT_PULLUP);
    pinMode(motor.b, INPUT_PULLUP);
    it.port_a = portInputRegister(digitalPinToPort(motor.a));
    it.port_b = portInputRegister(digitalPinToPort(motor.b));
    it.bit_a = digitalPinToBitMask(motor.a);
    it.bit_b = digitalPinToBitMask(motor.b);
  }
  delayMicroseconds(20); // until the pull-ups have pulled
  for (uint8_t n = 0; n < MOTORS; n++) {
    encoders[n].before = levels(encoders[n]);
    const uint8_t pins[] = {ROBOT[n].a, ROBOT[n].b};
    for (uint8_t pin : pins) {
      if (digitalPinToInterrupt(pin) != NOT_AN_INTERRUPT) {
        attachInterrupt(digitalPinToInterrupt(pin), n == 0 ? first : second, CHANGE);
      } else {
        *digitalPinToPCMSK(pin) |= bit(digitalPinToPCMSKbit(pin));
        *digitalPinToPCICR(pin) |= bit(digitalPinToPCICRbit(pin));
      }
    }
  }
}

int32_t encoder_count(uint8_t motor) {
  int32_t count = 0;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { count = encoders[motor].count; }
  return count;
}

void encoders_clear() {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    for (Encoder &it : encoders) {
      it.count = 0;
    }
  }
}
