"""The whole object dictionary of the EPOS2: one row per object, by its address.

Source: maxon EDS for the EPOS2 70/10, software 2126h: 156 indexes, 430 objects. Objects that stand in other
drives' manuals only (0x605A, 0x1006, 0x60C1 and so on) do not exist here.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.wire.epos2.objects_communication import COMMUNICATION
from firmware_bridge.wire.epos2.objects_io import INPUTS_OUTPUTS
from firmware_bridge.wire.epos2.objects_pdo import PROCESS_OBJECTS
from firmware_bridge.wire.epos2.objects_profile import DEVICE_PROFILE
from firmware_bridge.wire.epos2.objects_sensor import SENSORS
from firmware_bridge.wire.epos2.objects_system import SYSTEM

_CHAPTERS: Final = (
    COMMUNICATION,
    PROCESS_OBJECTS,
    SYSTEM,
    INPUTS_OUTPUTS,
    SENSORS,
    DEVICE_PROFILE,
)

OBJECTS: Final[Mapping[Address, ObjectRow]] = MappingProxyType(
    {row.address: row for row in sorted((row for rows in _CHAPTERS for row in rows), key=lambda r: r.address)}
)
"""Every object, in the order of the addresses."""

INDEXES: Final = frozenset(address.index for address in OBJECTS)
"""Every index that has at least one object."""
