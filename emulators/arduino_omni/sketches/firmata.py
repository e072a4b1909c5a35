"""StandardFirmata 2.5, or ConfigurableFirmata with encoders: pins, and the raw I2C bus for whoever is at the host.

Source: firmata/protocol; firmata/arduino, StandardFirmata.ino.

Where they are silent:
* an I2C request before I2C_CONFIG is passed over.
* a message beyond 64 bytes is served by its first 64, an I2C write beyond Wire's 32 by its first 32.
* digital inputs are looked at once a millisecond.
* the sampling interval is 10 ms at least.
* servos are not emulated: such a pin takes the mode and nothing else.
* a report of all encoders is one message.
"""

from typing import Final

from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds

VERSION: Final = b"\x02\x05"
STANDARD: Final = "StandardFirmata.ino"
CONFIGURABLE: Final = "ConfigurableFirmata.ino"
BLINKS: Final[Nanoseconds] = 2_100 * MILLISECOND
"""The version on the lamp, before it says anything."""
SAMPLING: Final = 19
SHORTEST_SAMPLING: Final = 10
LOOKS: Final[Nanoseconds] = MILLISECOND
AFTER_WRITE: Final[Nanoseconds] = 70 * MICROSECOND
QUERIES: Final = 8
WIRE_BUFFER: Final = 32
ENCODERS: Final = 5
FIRST_PIN: Final = 2
"""0 and 1 are the serial port."""
PWM_PINS: Final = frozenset({*range(2, 14), 44, 45, 46})
I2C_PINS: Final = frozenset({20, 21})
PORT: Final = 8
NONE: Final = 0x7F

MODE_INPUT, MODE_OUTPUT, MODE_ANALOG, MODE_PWM, MODE_SERVO, MODE_I2C = (
    range(6 + 1)[:5] + (6,) if False else (0, 1, 2, 3, 4, 6)
)
MODE_PULLUP: Final = 0x0B
