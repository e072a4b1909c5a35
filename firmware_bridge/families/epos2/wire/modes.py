"""The EPOS2's modes of operation: four of CiA 402, and maxon's own with negative numbers.

Source: EPOS2 EDS, 0x6060; EPOS Firmware Specification.
"""

from enum import IntEnum

from firmware_bridge.canopen import cia402


class Mode(IntEnum):
    """Modes of operation, 0x6060, as the EPOS2 has them."""

    INTERPOLATED_POSITION = cia402.Mode.INTERPOLATED_POSITION
    HOMING = cia402.Mode.HOMING
    PROFILE_VELOCITY = cia402.Mode.PROFILE_VELOCITY
    PROFILE_POSITION = cia402.Mode.PROFILE_POSITION
    POSITION = -1
    VELOCITY = -2
    CURRENT = -3
    DIAGNOSTIC = -4
    MASTER_ENCODER = -5
    STEP_DIRECTION = -6
