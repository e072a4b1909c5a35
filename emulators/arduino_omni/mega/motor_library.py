"""I2C transfers of Adafruit's Motor Shield V2 library, call by call, byte for byte.

Source: Adafruit_Motor_Shield_V2_Library and its Adafruit_MS_PWMServoDriver, as of 2018; BusIO since
2021-09-21.
"""

from collections.abc import Iterator
from enum import IntEnum
from math import floor
from typing import Final

from emulators.arduino_omni.mega.arithmetic import float32
from emulators.arduino_omni.mega.jobs import Delay, Job, OnBus
from emulators.arduino_omni.shield.i2c import Transfer, TransferSegment, read, write
from emulators.arduino_omni.shield.motor_shield import PORTS, Port
from emulators.arduino_omni.shield.pca9685 import (
    AI,
    ALL_LED,
    ALLCALL,
    CHANNELS,
    FULL,
    LED0,
    MODE1,
    OSCILLATOR_HZ,
    PERIOD_COUNTS,
    PRE_SCALE,
    RESTART,
    SLEEP,
)
from firmware_bridge.units import MILLISECOND

DEFAULT_HZ: Final = 1_600
CORRECTION: Final = float32(0.9)
"""Correction of the frequency, since 2015-09-12."""
WAKES_IN: Final = 5 * MILLISECOND
FULL_ON: Final = 4_096
BYTE: Final = 255
FINEST: Final = 4_095
COUNTS_PER_STEP: Final = 16
"""setSpeed() counts to 255."""


class RunArgument(IntEnum):
    """The argument of run(). BRAKE has no case in the library: nothing is written."""

    FORWARD = 1
    BACKWARD = 2
    BRAKE = 3
    RELEASE = 4


def pre_scale(frequency: int) -> int:
    """Return what begin() writes for a frequency in Hz: 8 bits of the rounded quotient, in floats.

    A frequency of 0 divides to infinity, which avr-libc converts to 0; above 13.5 kHz it is -1, so 255.
    """
    if frequency == 0:
        return 0
    # 25 MHz / 4096 / (f * 0.9) - 1, rounded: 1600 Hz give 3, and a true 1525.88 Hz.
    divider = float32(float32(OSCILLATOR_HZ / PERIOD_COUNTS) / float32(frequency * CORRECTION))
    return floor(float32(float32(divider - 1) + 0.5)) & BYTE


def pwm(channel: int, on: int, off: int) -> bytes:
    """Return the write that sets a channel."""
    return bytes((LED0 + 4 * channel, on & BYTE, on >> 8 & BYTE, off & BYTE, off >> 8 & BYTE))


def set_pin(channel: int, *, high: bool) -> bytes:
    """Return the write that sets a channel to one level."""
    return pwm(channel, FULL_ON if high else 0, 0)


def set_speed(port: Port, speed: int) -> bytes:
    """Return the write of setSpeed(); speed 0 to 255."""
    # 255 * 16 is 4080 of 4096: 99.6 %, never fully on.
    return pwm(port.pwm, 0, (speed & BYTE) * COUNTS_PER_STEP)


def set_speed_fine(port: Port, speed: int) -> bytes:
    """Return the write of setSpeedFine(), there since 2021; speed 0 to 4095."""
    return pwm(port.pwm, 0, min(speed, FINEST))


def run(port: Port, command: int) -> tuple[bytes, ...]:
    """Return the writes of a run command; nothing for what the library has no case for."""
    if command == RunArgument.FORWARD:
        # LOW before HIGH, as in the library: both HIGH in between would be a short brake.
        return set_pin(port.in2, high=False), set_pin(port.in1, high=True)
    if command == RunArgument.BACKWARD:
        return set_pin(port.in1, high=False), set_pin(port.in2, high=True)
    if command == RunArgument.RELEASE:
        return set_pin(port.in1, high=False), set_pin(port.in2, high=False)
    return ()


def motor(number: int) -> Port | None:
    """Return what getMotor(1) to getMotor(4) give; nothing for another number."""
    return PORTS[number - 1] if 1 <= number <= len(PORTS) else None


def begin(address: int, frequency: int = DEFAULT_HZ, *, repeated_start: bool = False) -> Iterator[Job]:
    """Yield the jobs that set the shield up; `repeated_start` as the library reads since 2021, unprobed.

    MODE1 is read, and what is written after it follows from the 0 that has just been written there.
    """
    yield OnBus(write(address, bytes((MODE1, 0))))
    if repeated_start:
        yield OnBus(
            Transfer((TransferSegment(address, bytes((MODE1,))), TransferSegment(address, to_read=1)))
        )
    else:
        yield OnBus(write(address, bytes((MODE1,))))
        yield OnBus(read(address, 1))
    # PRE_SCALE is writable only while SLEEP is set.
    yield OnBus(write(address, bytes((MODE1, SLEEP))))
    yield OnBus(write(address, bytes((PRE_SCALE, pre_scale(frequency)))))
    yield OnBus(write(address, bytes((MODE1, 0))))
    yield Delay(WAKES_IN)
    yield OnBus(write(address, bytes((MODE1, RESTART | AI | ALLCALL))))
    for channel in range(CHANNELS):
        yield OnBus(write(address, set_pin(channel, high=False)))


def release_all(address: int) -> Job:
    """Return the transfer that releases all motors at once, whatever their state on the shield."""
    return OnBus(write(address, bytes((ALL_LED + 3, FULL))))


def drive(address: int, port: Port, speed: int, command: int) -> Iterator[Job]:
    """Yield setSpeed() and then run()."""
    yield OnBus(write(address, set_speed(port, speed)))
    for data in run(port, command):
        yield OnBus(write(address, data))
