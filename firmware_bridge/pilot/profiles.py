"""Profiles of the robot's telemetry: requested intervals, by the messages' numbers."""

from types import MappingProxyType
from typing import Final, TypeAlias

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.units import MILLISECOND, Nanoseconds

Profile: TypeAlias = MappingProxyType[int, Nanoseconds]

_CYCLE: Final[Nanoseconds] = 50 * MILLISECOND

PROFILES: Final[MappingProxyType[str, Profile]] = MappingProxyType(
    {
        "usual": MappingProxyType({}),
        "cycle": MappingProxyType(
            {
                dialect.MAVLINK_MSG_ID_ODOMETRY: _CYCLE,
                dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT: _CYCLE,
                dialect.MAVLINK_MSG_ID_DEBUG_FLOAT_ARRAY: _CYCLE,
                dialect.MAVLINK_MSG_ID_BATTERY_STATUS: _CYCLE,
            }
        ),
    }
)
"""`usual`: as the robot sends it.

`cycle`: all fields of the packet of A. P. Das, PhD thesis, IIT Delhi, 2018, Fig. 4.3, at its 20 Hz: pose;
angles, heights and each motor's current by name; the rolling axes' speeds; the battery's voltage.
"""
USUAL: Final = PROFILES["usual"]
ORDER: Final = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
