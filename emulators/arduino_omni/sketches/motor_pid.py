"""The speed loop of ros_arduino_bridge, a motor at a time, in the integers that the AVR has.

Source: hbrobotics/ros_arduino_bridge, diff_controller.h: differences of counts a frame, derivative on the
measurement, the output added to the one before, clamped at 255. int is 16 bits, long 32.
"""

from dataclasses import dataclass, field
from typing import Final

from emulators.arduino_omni.mega.arithmetic import int16, int32, quotient

MAX_PWM: Final = 255


@dataclass(slots=True)
class Gains:
    """Gains of all motors; int."""

    kp: int = 20
    kd: int = 12
    ki: int = 0
    ko: int = 50


@dataclass(slots=True)
class MotorPid:
    """One motor."""

    gains: Gains
    target: int = 0
    """Target speed in ticks per frame."""
    output: int = 0
    encoder: int = 0
    _before: int = field(default=0)
    _input_before: int = field(default=0)
    _integral: int = field(default=0)

    @property
    def turned(self) -> bool:
        """True if it moved in the frame before."""
        return self._input_before != 0

    def reset(self, encoder: int) -> None:
        """Begin at rest, at a count."""
        self.target = self.output = self._input_before = self._integral = 0
        self.encoder = self._before = encoder

    def update(self, encoder: int) -> int:
        """Take the count at a frame's end; return the PWM, -255 to 255."""
        gains = self.gains
        # int has 16 bits: more than 32767 counts a frame wrap, as on the AVR.
        moved = int16(encoder - self._before)
        error = int32(self.target - moved)
        # Derivative on the measurement: a new target gives no kick.
        damped = int16(gains.kd * int16(moved - self._input_before))
        wanted = quotient(int32(int32(gains.kp * error) - damped + self._integral), gains.ko)
        wanted = int32(wanted + self.output)
        if wanted >= MAX_PWM:
            wanted = MAX_PWM
        elif wanted <= -MAX_PWM:
            wanted = -MAX_PWM
        else:
            # Anti-windup of the original: the integral grows only while the output is not clamped.
            self._integral = int16(self._integral + int32(gains.ki * error))
        self.encoder = self._before = encoder
        self.output = wanted
        self._input_before = moved
        return wanted
