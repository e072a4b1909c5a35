"""I2C writes to the chip of the motor shield V2: registers, channels, terminals.

Sources: NXP, PCA9685 data sheet, registers; Adafruit_Motor_Shield_V2_Library, begin(), getMotor(), run().
"""

from collections.abc import Mapping
from enum import Enum
from types import MappingProxyType
from typing import Final, NamedTuple

ADDRESS: Final = 0x60
MODE1: Final = 0x00
LED0: Final = 0x06
"""Four registers for each channel: ON and OFF, low byte first."""
CHANNEL: Final = 4
PRE_SCALE: Final = 0xFE
FULL_ON: Final = 0x1000
STEPS: Final = 16
"""Of the chip's 4096 counts for each of setSpeed()'s 255."""

SET_UP: Final = (
    bytes((MODE1, 0x00)),
    bytes((MODE1, 0x10)),
    bytes((PRE_SCALE, 0x03)),
    bytes((MODE1, 0x00)),
    bytes((MODE1, 0xA1)),
)
"""As begin() of 1.6 kHz writes it: awake, asleep for the pre-scaler, awake, restarted with auto-increment."""


class Pin(Enum):
    """An input of a half bridge."""

    PWM = "pwm"
    IN1 = "in1"
    IN2 = "in2"


class Terminal(NamedTuple):
    """The channels of one motor."""

    pwm: int
    in1: int
    in2: int


TERMINALS: Final[Mapping[int, Terminal]] = MappingProxyType(
    {1: Terminal(8, 10, 9), 2: Terminal(13, 11, 12), 3: Terminal(2, 4, 3), 4: Terminal(7, 5, 6)}
)
"""Terminals by the motor's number."""
PINS: Final[Mapping[int, tuple[int, Pin]]] = MappingProxyType(
    {
        LED0 + CHANNEL * channel: (motor, pin)
        for motor, terminal in TERMINALS.items()
        for channel, pin in zip(terminal, Pin, strict=True)
    }
)
"""Motor and input by the first register of a channel."""


def encode_channel(motor: int, pin: Pin, level: int) -> bytes:
    """Return the write of one channel: a speed of 0 to 255 on PWM, 0 or 1 on the others."""
    channel = getattr(TERMINALS[motor], pin.value)
    # PWM: on at count 0, off at the speed's count. A direction pin is full on by bit 12 of ON, else 0.
    on, off = (0, level * STEPS) if pin is Pin.PWM else (FULL_ON if level else 0, 0)
    # ON and OFF of a channel are 16 bits each, low byte first, in registers that follow each other.
    return bytes((LED0 + CHANNEL * channel, on & 0xFF, on >> 8, off & 0xFF, off >> 8))


class Written(NamedTuple):
    """The effect of a write on one input; `level` in the same steps, a share of one rounded up."""

    motor: int
    pin: Pin
    level: int


def decode_channel(data: bytes) -> Written | None:
    """Return what a write of one whole channel does; None for another write."""
    known = PINS.get(data[0]) if len(data) == 1 + CHANNEL else None
    if known is None:
        return None
    on, off = int.from_bytes(data[1:3], "little"), int.from_bytes(data[3:5], "little")
    # Full off has priority over full on (PCA9685); else the pulse may run over the end of the 4096 counts.
    counts = 0 if off & FULL_ON else FULL_ON if on & FULL_ON else (off - on) % FULL_ON
    motor, pin = known
    # Rounded up: the guard must not see less speed than the chip gives.
    return Written(motor, pin, -(-counts // STEPS) if pin is Pin.PWM else int(counts > 0))
