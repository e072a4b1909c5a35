"""Severity of each kind of fault: keys beside time, place and duration. Kinds not listed here have none.

Beyond the limits of the device where it has one, so that it must be noticed; where a fault can be small
enough to be taken for the world, it is as large as an engineer would call broken. All figures are assumed.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

Keys = Mapping[str, Any]

_NMT: Final = ("stop", "enter_pre_operational", "reset_node", "reset_communication")
_STATIONS: Final = ("take", "arm", "disarm", "emergency stop", "garbage")

SEVERE: Final[Mapping[str, tuple[Keys, ...]]] = MappingProxyType(
    {
        "nmt_foreign_node": tuple({"command": command} for command in _NMT),
        # A SYNC, and the heartbeat of a node in the NMT state stopped.
        "stray_frames": ({"identifier": 0x080, "every_ms": 5}, {"identifier": 0x701, "data": "04"}),
        "supply_sag": ({"to_v": 8.0}, {"to_v": 13.0}),
        "supply_surge": ({"to_v": 80.0},),
        "logic_supply_sag": ({"to_v": 3.0},),
        "gate_supply_sag": ({"to_v": 3.0},),
        "overheating": ({"to_celsius": 150.0},),
        "encoder_counts_lost": ({"share": 0.5},),
        "motor_supply_sag": ({"to_v": 3.0},),
        "datagram_late": ({"by_ms": 700.0},),
        "datagram_doubled": ({"after_ms": 200.0},),
        "capture_late": ({"by_ms": 500.0},),
        "body_shakes": ({"noise_mm": 30.0},),
        "bridge_ends": ({"how": "interrupted"}, {"how": "killed"}),
        "second_station": tuple({"order": order, "stick": 1.0} for order in _STATIONS),
    }
)
