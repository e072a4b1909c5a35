"""Causes of CiA 402 drives' errors by their codes; CiA 301 and CiA 402."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

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
