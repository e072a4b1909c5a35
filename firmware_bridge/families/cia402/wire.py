"""Objects and error codes of CiA 402 that only drives of any maker use here.

Sources: CiA 402-2 for objects; CiA 301 and CiA 402 for error codes.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.address import Address

MAX_CURRENT: Final = Address(0x6073)
RATED_CURRENT: Final = Address(0x6075)
SUPPLY: Final = Address(0x6079)
MAX_MOTOR_SPEED: Final = Address(0x6080)
FACTORS: Final[Mapping[Address, str]] = MappingProxyType(
    {
        Address(0x608F, 1): "encoder_counts",
        Address(0x608F, 2): "encoder_turns",
        Address(0x6091, 1): "gear_motor_turns",
        Address(0x6091, 2): "gear_shaft_turns",
        Address(0x6092, 1): "feed",
        Address(0x6092, 2): "feed_turns",
    }
)
"""Of the positions, by their keys in a robot file."""
PERIOD: Final = Address(0x60C2, 1)
CAUSES: Final[Mapping[int, str]] = MappingProxyType(
    {
        0x1000: "generic error",
        0x2310: "over-current",
        0x2320: "short circuit",
        0x3210: "DC link over-voltage",
        0x3220: "DC link under-voltage",
        0x4210: "over-temperature of the drive",
        0x4310: "over-temperature of the drive",
        0x5442: "positive limit switch",
        0x5443: "negative limit switch",
        0x6320: "parameter",
        0x7305: "incremental encoder",
        0x8110: "CAN overrun",
        0x8120: "CAN error passive",
        0x8130: "life guard or heartbeat",
        0x8150: "COB-ID collision",
        0x8210: "PDO too short",
        0x8250: "PDO not received in time",
        0x8611: "following error",
        0x8612: "target outside the position limits",
    }
)
