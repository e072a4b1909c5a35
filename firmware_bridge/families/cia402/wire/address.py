"""Objects of CiA 402 drives by their addresses, beside those that `firmware_bridge.canopen.objects` has.

Source: CiA 402-2; those at 0x2000 are the emulated servo's own.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.address import Address

NODE_NUMBER: Final = Address(0x2000)
BIT_RATE: Final = Address(0x2001)
BIT_RATE_IN_USE: Final = Address(0x2002)
ERROR_CODE: Final = Address(0x603F)
FOLLOWING_ERROR_TIME: Final = Address(0x6066)
STANDSTILL_WINDOW: Final = Address(0x606F)
STANDSTILL_TIME: Final = Address(0x6070)
TARGET_TORQUE: Final = Address(0x6071)
MAX_TORQUE: Final = Address(0x6072)
MAX_CURRENT: Final = Address(0x6073)
TORQUE_DEMAND: Final = Address(0x6074)
RATED_CURRENT: Final = Address(0x6075)
TORQUE_ACTUAL: Final = Address(0x6077)
SUPPLY: Final = Address(0x6079)
MAX_MOTOR_SPEED: Final = Address(0x6080)
POSITION_INTERNAL: Final = Address(0x6063)
ENCODER_COUNTS: Final = Address(0x608F, 1)
ENCODER_TURNS: Final = Address(0x608F, 2)
GEAR_MOTOR_TURNS: Final = Address(0x6091, 1)
GEAR_SHAFT_TURNS: Final = Address(0x6091, 2)
FEED: Final = Address(0x6092, 1)
FEED_TURNS: Final = Address(0x6092, 2)
POSITION_OFFSET: Final = Address(0x60B0)
VELOCITY_OFFSET: Final = Address(0x60B1)
TORQUE_OFFSET: Final = Address(0x60B2)
PERIOD: Final = Address(0x60C2, 1)
PERIOD_EXPONENT: Final = Address(0x60C2, 2)
FOLLOWING_ERROR: Final = Address(0x60F4)
INPUTS: Final = Address(0x60FD)
FACTORS: Final[Mapping[Address, str]] = MappingProxyType(
    {
        ENCODER_COUNTS: "encoder_counts",
        ENCODER_TURNS: "encoder_turns",
        GEAR_MOTOR_TURNS: "gear_motor_turns",
        GEAR_SHAFT_TURNS: "gear_shaft_turns",
        FEED: "feed",
        FEED_TURNS: "feed_turns",
    }
)
"""Of the positions, by their keys in a robot file."""
