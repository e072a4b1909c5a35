#include "motor_pid.h"

// What overflows wraps: without this a compiler may take it that nothing does.
#pragma GCC optimize("wrapv")

Gains gains = {20, 12, 0, 50};

void MotorPid::reset(int32_t count) {
  target = moved_before = integral = 0;
  output = 0;
  before = count;
}

int16_t MotorPid::update(int32_t count) {
  int16_t moved = count - before;
  int32_t error = (int32_t)target - moved;
  int16_t step = moved - moved_before;
  int16_t damped = gains.kd * step;
  int32_t wanted = (gains.kp * error - damped + integral) / gains.ko + output;
  if (wanted >= MAX_PWM) {
    wanted = MAX_PWM;
  } else if (wanted <= -MAX_PWM) {
    wanted = -MAX_PWM;
  } else {
    integral += gains.ki * error;
  }
  before = count;
  moved_before = moved;
  output = wanted;
  return output;
}
