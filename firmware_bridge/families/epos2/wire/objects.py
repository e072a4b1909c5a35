"""The EPOS2 70/10's object table: one row per object, chapter by chapter.

Source: maxon EDS for the EPOS2 70/10, software 2126h: 156 indexes, 430 objects. Objects that stand in other
drives' manuals only (0x605A, 0x1006, 0x60C1 and so on) do not exist here. `differences.objects_of` makes the
object dictionary of a type from it.
"""

from typing import Final

from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.epos2.wire.objects_communication import COMMUNICATION
from firmware_bridge.families.epos2.wire.objects_io import INPUTS_OUTPUTS
from firmware_bridge.families.epos2.wire.objects_pdo import PROCESS_OBJECTS
from firmware_bridge.families.epos2.wire.objects_profile import DEVICE_PROFILE
from firmware_bridge.families.epos2.wire.objects_sensor import SENSORS
from firmware_bridge.families.epos2.wire.objects_system import SYSTEM

ROWS: Final[tuple[ObjectRow, ...]] = (
    *COMMUNICATION,
    *PROCESS_OBJECTS,
    *SYSTEM,
    *INPUTS_OUTPUTS,
    *SENSORS,
    *DEVICE_PROFILE,
)
