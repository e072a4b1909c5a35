"""The command of one motor: ticks for a loop on the board; PWM by a PI here, where the board has none.

A reversal passes 0 for a cycle, however soon the next command is sent, and the PWM changes no faster than its
slope: at once it would draw twice the current of a stall.
"""

import math
from typing import Final

from firmware_bridge.families.motor_shield.settings import FULL_PWM, ShieldAxis
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.robot import Axis
from firmware_bridge.units import MILLISECOND, RPM_PER_RAD_S, SECOND, Nanoseconds, to_seconds

LONGEST: Final = 2
"""Cycles that a step lasts at most, whatever the time since the one before."""
STOPPED_AFTER: Final = 3
"""Cycles without a step, as of a bridge that was not run, after which the guard has stopped the motor."""


class _Reversal:
    """Output of a motor, which stays at 0 for a while before it is reversed.

    A cycle may be a little short, and commands may be sent between two cycles.
    """

    def __init__(self, cycle: Nanoseconds) -> None:
        self.output = 0
        self._pause: Final = cycle * 3 // 4
        self._stood: Nanoseconds = 0
        self._sign = 0
        """Of the newest output that was not 0."""

    def next(self, output: int, elapsed: Nanoseconds) -> int:
        """Return an output, or 0 where it would reverse too soon; `elapsed` since the one before."""
        if self.output == 0:
            self._stood += elapsed
        if output * self._sign < 0 and (self.output != 0 or self._stood < self._pause):
            output = 0
        if output != 0:
            self._sign = 1 if output > 0 else -1
        if self.output != 0:
            self._stood = 0
        self.output = output
        return output

    def stop(self) -> None:
        """Be at 0 from now on."""
        self.next(0, 0)


class Ticks:
    """Speeds for a loop on the board, in counts a frame."""

    def __init__(self, axis: Axis, cycle: Nanoseconds) -> None:
        per_unit = ShieldAxis.of(axis).counts_per_unit(axis.ratio)
        self._ticks: Final = axis.direction * per_unit * ros.FRAME_MS * MILLISECOND / SECOND
        self._most: Final = math.floor(abs(self._ticks) * axis.top_speed)
        self._reversal: Final = _Reversal(cycle)

    @property
    def output(self) -> int:
        """The newest one."""
        return self._reversal.output

    def next(self, wanted: float, _velocity: float | None, elapsed: Nanoseconds) -> int:
        """Return ticks a frame for a speed in the axis's unit a second."""
        ticks = min(max(round(wanted * self._ticks), -self._most), self._most)
        return self._reversal.next(ticks, elapsed)

    def reset(self) -> None:
        """Begin at standstill."""
        self._reversal.stop()


class Pwm:
    """A PI with feed-forward; PWM of 255, in steps no larger than the slope lets."""

    def __init__(self, axis: Axis, cycle: Nanoseconds) -> None:
        motor = ShieldAxis.of(axis)
        free = motor.full_speed_rpm / RPM_PER_RAD_S / axis.ratio
        self._forward: Final = FULL_PWM / free
        self._gains: Final = motor.regulator
        self._direction: Final = axis.direction
        self._standstill_below: Final = axis.standstill_below
        self._most: Final = motor.max_pwm
        self._slope: Final = motor.slope_pwm_s
        self._cycle: Final = cycle
        self._behind = 0.0
        """Of the motion that was wanted, in the axis's unit."""
        self._reversal: Final = _Reversal(cycle)

    @property
    def output(self) -> int:
        """The newest one."""
        return self._reversal.output

    def next(self, wanted: float, velocity: float | None, elapsed: Nanoseconds) -> int:
        """Return the PWM, with the motor's sign; `velocity` is None where nothing measures it."""
        if elapsed > STOPPED_AFTER * self._cycle:
            self._behind = 0.0
            return self._reversal.next(0, elapsed)
        return self._reversal.next(self._pwm(wanted, velocity, elapsed), elapsed)

    def _pwm(self, wanted: float, velocity: float | None, elapsed: Nanoseconds) -> int:
        seconds = to_seconds(min(elapsed, LONGEST * self._cycle))
        if wanted == 0.0:
            # It shall stand: what it is behind would drive it back.
            self._behind = 0.0
            brakes = (
                0.0
                if velocity is None or abs(velocity) < self._standstill_below
                else -self._gains.p * velocity
            )
            return self._stepped(self._direction * brakes, seconds)
        fed = self._forward * wanted + math.copysign(self._gains.start, wanted)
        error = 0.0 if velocity is None else wanted - velocity
        behind = self._behind + error * seconds
        pwm = fed + self._gains.p * error + self._gains.i * behind
        # At the limit what is behind may only shrink: otherwise it winds up, and the motor overshoots.
        if abs(pwm) <= self._most or abs(behind) < abs(self._behind):
            self._behind = behind
        return self._stepped(self._direction * pwm, seconds)

    def reset(self) -> None:
        """Begin at standstill."""
        self._behind = 0.0
        self._reversal.stop()

    def _stepped(self, pwm: float, seconds: float) -> int:
        reach = math.floor(self._slope * seconds)
        before = self.output
        return min(max(round(pwm), before - reach, -self._most), before + reach, self._most)
