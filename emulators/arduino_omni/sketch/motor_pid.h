// The speed loop of a motor, 30 times a second, in integers: ros_arduino_bridge's, term by term.
#pragma once

#include <stdint.h>

const int16_t MAX_PWM = 255;

struct Gains {
  int16_t kp, kd, ki, ko;
};

extern Gains gains;

struct MotorPid {
  int16_t target; // counts a frame
  int32_t output; // -255 to 255

  void reset(int32_t count);
  int16_t update(int32_t count);
  bool turned() const { return moved_before != 0; }

private:
  int32_t before;
  int16_t moved_before;
  int16_t integral;
};
