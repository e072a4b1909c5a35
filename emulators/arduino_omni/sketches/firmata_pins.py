"""Modes of each pin of a Mega, in Firmata's numbers.

Sources: firmata/protocol, protocol.md; firmata/arduino, the Mega's part of Boards.h. Assumed: modes are
reported in the order input, pull-up, output, analog, PWM, servo, I2C, encoder.
"""

from typing import Final

from emulators.arduino_omni.mega.pins import FIRST_ANALOG, INPUT, OUTPUT, PINS

FIRST_PIN: Final = 2
"""0 and 1 are the serial port."""
PWM_PINS: Final = frozenset({*range(2, 14), 44, 45, 46})
LAST_SERVO: Final = 49
I2C_PINS: Final = frozenset({20, 21})
PORT: Final = 8
NO_CHANNEL: Final = 0x7F

MODE_ANALOG: Final = 0x02
MODE_PWM: Final = 0x03
MODE_SERVO: Final = 0x04
MODE_I2C: Final = 0x06
MODE_ENCODER: Final = 0x09
MODE_PULLUP: Final = 0x0B
RESOLUTIONS: Final = {
    INPUT: 1,
    MODE_PULLUP: 1,
    OUTPUT: 1,
    MODE_ANALOG: 10,
    MODE_PWM: 8,
    MODE_SERVO: 14,
    MODE_I2C: 1,
    MODE_ENCODER: 28,
}


def modes(pin: int, *, encoders: bool) -> tuple[int, ...]:
    """Return what a pin can be."""
    if not FIRST_PIN <= pin < PINS:
        return ()
    able = {
        MODE_ANALOG: pin >= FIRST_ANALOG,
        MODE_PWM: pin in PWM_PINS,
        MODE_SERVO: pin <= LAST_SERVO,
        MODE_I2C: pin in I2C_PINS,
        MODE_ENCODER: encoders and pin in {2, 3, 18, 19, 20, 21},
    }
    return tuple(mode for mode in RESOLUTIONS if able.get(mode, True))
