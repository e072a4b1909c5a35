// ROME's base: three wheels behind ros_arduino_bridge's lines, on an Arduino Mega 2560 with a motor shield.
//
// 57600 baud. A command is a letter and decimal words, ended by CR; README.md has all of them.

#include <Arduino.h>

#include "encoders.h"
#include "motor_pid.h"
#include "robot.h"
#include "shield.h"

const uint32_t BAUD = 57600;
const uint32_t FRAME_MS = 1000 / 30;
const uint32_t ECHO_US = 30000; // of a ping, 5 m. Nothing may keep the sketch from its auto-stop
const uint8_t WORD = 16;        // characters of an argument, the last of them a zero
const uint8_t GAINS = 4;

static MotorPid pids[MOTORS];
static bool moving; // the loop is on
static bool driven; // a motor may run that the auto-stop has to stop
static uint32_t commanded_at;
static uint32_t next_frame = FRAME_MS;

static char letter;
static uint8_t place; // 0: the letter; 1 and on: the words
static uint8_t lengths[MOTORS];
static char words[MOTORS][WORD];

static int16_t number(uint8_t word) { return atoi(words[word]); }

static void say_ok() { Serial.println(F("OK")); }

static void reset_pids() {
  for (uint8_t n = 0; n < MOTORS; n++) {
    pids[n].reset(encoder_count(n));
  }
}

static void stop() {
  const int16_t still[MOTORS] = {};
  moving = false;
  driven = !shield_drive(still); // what the shield has not heard is said again
}

// A pin that motors, host or shield hang on is none that a command may have.
static bool in_use(uint8_t pin) {
  for (uint8_t it : SERIAL_AND_I2C) {
    if (pin == it) {
      return true;
    }
  }
  for (const Motor &it : ROBOT) {
    if (pin == it.a || pin == it.b) {
      return true;
    }
  }
  return false;
}

static bool is_free(uint8_t pin) { return pin < NUM_DIGITAL_PINS && !in_use(pin); }

static bool take_three(int16_t numbers[]) {
  bool any = false;
  commanded_at = millis();
  for (uint8_t n = 0; n < MOTORS; n++) {
    numbers[n] = number(n);
    any |= numbers[n] != 0;
  }
  return any;
}

static void read_analog() { Serial.println(analogRead((uint8_t)number(0))); }

static void say_baud() { Serial.println(BAUD); }

static void configure_pin() {
  const uint8_t pin = number(0);
  const int16_t mode = number(1);
  if (is_free(pin) && (mode == INPUT || mode == OUTPUT)) {
    pinMode(pin, mode);
  }
  say_ok();
}

// The core would look for a pin that is none behind the end of its table.
static void read_pin() {
  const uint8_t pin = number(0);
  Serial.println(pin < NUM_DIGITAL_PINS ? digitalRead(pin) : 0);
}

static void read_encoders() {
  for (uint8_t n = 0; n < MOTORS; n++) {
    if (n) {
      Serial.print(' ');
    }
    Serial.print(encoder_count(n));
  }
  Serial.println();
}

static void set_speeds() {
  int16_t targets[MOTORS];
  if (take_three(targets)) {
    if (!moving) {
      reset_pids(); // the motors may have been pushed since
    }
    moving = driven = true;
  } else {
    stop();
    reset_pids();
  }
  for (uint8_t n = 0; n < MOTORS; n++) {
    pids[n].target = targets[n];
  }
  say_ok();
}

static void set_pwm() {
  int16_t speeds[MOTORS];
  reset_pids();
  moving = false;
  driven = take_three(speeds);
  driven |= !shield_drive(speeds);
  say_ok();
}

static void ping() {
  const uint8_t pin = number(0);
  uint32_t echo = 0;
  if (is_free(pin)) {
    pinMode(pin, OUTPUT);
    digitalWrite(pin, LOW);
    delayMicroseconds(2);
    digitalWrite(pin, HIGH);
    delayMicroseconds(5);
    digitalWrite(pin, LOW);
    pinMode(pin, INPUT);
    echo = pulseIn(pin, HIGH, ECHO_US);
  }
  Serial.println(echo / 29 / 2); // us to cm, there and back
}

static void reset_encoders() {
  encoders_clear();
  reset_pids();
  say_ok();
}

static void set_gains() {
  int16_t *const all[GAINS] = {&gains.kp, &gains.kd, &gains.ki, &gains.ko};
  char *rest = words[0];
  for (uint8_t n = 0; n < GAINS; n++) {
    const char *word = strtok_r(rest, ":", &rest);
    if (!word) {
      break;
    }
    *all[n] = atoi(word);
  }
  say_ok();
}

static void write_pin() {
  const uint8_t pin = number(0);
  const int16_t level = number(1);
  if (is_free(pin) && (level == LOW || level == HIGH)) {
    digitalWrite(pin, level);
  }
  say_ok();
}

static void write_analog() {
  const uint8_t pin = number(0);
  if (is_free(pin)) {
    analogWrite(pin, number(1));
  }
  say_ok();
}

struct Command {
  char letter;
  void (*obey)();
};

static const Command COMMANDS[] = {
    {'a', read_analog}, {'b', say_baud}, {'c', configure_pin},  {'d', read_pin},  {'e', read_encoders}, {'m', set_speeds},
    {'o', set_pwm},     {'p', ping},     {'r', reset_encoders}, {'u', set_gains}, {'w', write_pin},     {'x', write_analog},
};

static void obey() {
  for (const Command &it : COMMANDS) {
    if (it.letter == letter) {
      it.obey();
      return;
    }
  }
  Serial.println(F("Invalid Command"));
}

static void forget() {
  letter = 0;
  place = 0;
  memset(lengths, 0, sizeof lengths);
  memset(words, 0, sizeof words);
}

// Whether a command was obeyed.
static bool take(char byte) {
  if (byte == '\r') {
    obey();
    forget();
    return true;
  }
  if (byte == ' ') {
    place += place <= MOTORS;
  } else if (place == 0) {
    letter = byte;
  } else if (place <= MOTORS && lengths[place - 1] < WORD - 1) {
    words[place - 1][lengths[place - 1]++] = byte;
  }
  return false;
}

static void frame() {
  if (moving) {
    int16_t speeds[MOTORS];
    for (uint8_t n = 0; n < MOTORS; n++) {
      speeds[n] = pids[n].update(encoder_count(n));
    }
    shield_drive(speeds);
    return;
  }
  for (const MotorPid &it : pids) {
    if (it.turned()) {
      reset_pids();
      return;
    }
  }
}

void setup() {
  shield_begin();
  encoders_begin();
  reset_pids();
  forget();
  Serial.begin(BAUD);
}

void loop() {
  // One command a turn: who floods the sketch holds up neither loop nor auto-stop.
  while (Serial.available() && !take(Serial.read())) {
  }
  if ((int32_t)(millis() - next_frame) > 0) {
    frame();
    next_frame += FRAME_MS;
  }
  if (driven && millis() - commanded_at > AUTO_STOP_MS) {
    stop();
  }
}
