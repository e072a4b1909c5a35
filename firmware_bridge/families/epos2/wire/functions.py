"""Functions of an EPOS2's digital pins: numbers in 0x2070 and 0x2079, bits of 0x2071 and 0x2078.

Sources: maxon's EPOS2 70/10 EDS (defaults), EPOS Firmware Specification (by analogy). Assumed: the number of
the holding brake.
"""

from enum import IntEnum
from typing import Final

from firmware_bridge.canopen.address import Address


class InputFunction(IntEnum):
    """Of an input pin; 6 to 15 are general purpose, J to A."""

    NEGATIVE_LIMIT = 0
    POSITIVE_LIMIT = 1
    HOME = 2
    POSITION_MARKER = 3
    DEVICE_ENABLE = 4
    QUICK_STOP = 5
    GENERAL_J = 6
    GENERAL_I = 7
    GENERAL_H = 8
    GENERAL_G = 9
    GENERAL_F = 10
    GENERAL_E = 11
    GENERAL_D = 12
    GENERAL_C = 13
    GENERAL_B = 14
    GENERAL_A = 15

    @property
    def bit(self) -> int:
        """The function's bit in 0x2071."""
        return 1 << self


class OutputFunction(IntEnum):
    """Of an output pin; 8 to 15 are general purpose, H to A."""

    READY = 0
    POSITION_COMPARE = 1
    HOLDING_BRAKE = 2
    GENERAL_H = 8
    GENERAL_G = 9
    GENERAL_F = 10
    GENERAL_E = 11
    GENERAL_D = 12
    GENERAL_C = 13
    GENERAL_B = 14
    GENERAL_A = 15

    @property
    def bit(self) -> int:
        """The function's bit in 0x2078."""
        return 1 << self


INPUT_PINS: Final = tuple(Address(0x2070, pin) for pin in range(1, 10))
"""Objects of each input pin's function, in the pins' order."""
INPUT_STATE: Final = Address(0x2071, 1)
INPUT_MASK: Final = Address(0x2071, 2)
INPUT_POLARITY: Final = Address(0x2071, 3)
INPUT_EXECUTION: Final = Address(0x2071, 4)
OUTPUT_STATE: Final = Address(0x2078, 1)
OUTPUT_MASK: Final = Address(0x2078, 2)
OUTPUT_POLARITY: Final = Address(0x2078, 3)
OUTPUT_PINS: Final = tuple(Address(0x2079, pin) for pin in range(1, 6))
"""Objects of each output pin's function, in the pins' order."""
GENERAL_OUTPUTS: Final = 0xFF00
"""Bits of 0x2078 that a master writes."""
