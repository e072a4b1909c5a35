"""The EPOS2's emergency codes: register bit, reaction, way back, cause.

Sources: EPOS Firmware Specification, chapter on error handling (causes and reactions, by analogy); the same
code list for the EPOS2 in maxon's command library up to FF0D; EPOS2 firmware notes for FF0F to FF12;
0x3220 with register 0x04 is recorded from an EPOS2.
"""

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.emergency import Emergency, FaultReaction, Recovery, RegisterBit
from firmware_bridge.canopen.object_row import Provenance
from firmware_bridge.families.epos2.wire.rows import FIRMWARE_SPECIFICATION, LIBRARY

GENERIC: Final = 0x1000
UNDER_VOLTAGE: Final = 0x3220
OVER_VOLTAGE: Final = 0x3210
OVER_CURRENT: Final = 0x2310
OVER_TEMPERATURE: Final = 0x4210
LOGIC_SUPPLY: Final = 0x5113
OUTPUT_STAGE_SUPPLY: Final = 0x5114
INTERNAL_SOFTWARE: Final = 0x6100
SOFTWARE_PARAMETER: Final = 0x6320
SENSOR_POSITION: Final = 0x7320
CAN_OBJECT_LOST: Final = 0x8110
CAN_OVERRUN: Final = 0x8111
CAN_PASSIVE: Final = 0x8120
CONNECTION_LOST: Final = 0x8130
COB_ID_COLLISION: Final = 0x8150
BUS_OFF: Final = 0x81FD
RECEIVE_QUEUE_OVERRUN: Final = 0x81FE
TRANSMIT_QUEUE_OVERRUN: Final = 0x81FF
PDO_TOO_SHORT: Final = 0x8210
FOLLOWING_ERROR_TOO_LARGE: Final = 0x8611
HALL_SENSOR: Final = 0xFF01
INDEX: Final = 0xFF02
ENCODER_RESOLUTION: Final = 0xFF03
HALL_NOT_FOUND: Final = 0xFF04
NEGATIVE_LIMIT: Final = 0xFF06
POSITIVE_LIMIT: Final = 0xFF07
HALL_ANGLE: Final = 0xFF08
POSITION_LIMIT: Final = 0xFF09
SENSOR_BREACH: Final = 0xFF0A
INTERPOLATION: Final = 0xFF0C
OVERLOADED: Final = 0xFF0B
IDENTIFICATION: Final = 0xFF0D
GEAR_SCALING: Final = 0xFF0F
CONTROLLER_GAIN: Final = 0xFF10
MAIN_SENSOR_DIRECTION: Final = 0xFF11
AUXILIARY_SENSOR_DIRECTION: Final = 0xFF12


_row: Final = partial(Emergency, source=FIRMWARE_SPECIFICATION)
_NONE = FaultReaction.NONE
_DISABLE = FaultReaction.DISABLE
_STOP = FaultReaction.QUICK_STOP
_COMMUNICATION = RegisterBit.COMMUNICATION
_PROFILE = RegisterBit.PROFILE
_MAKER = RegisterBit.MANUFACTURER
_ASSUMED = Provenance.ASSUMED
_NOTES = "EPOS2 firmware specification, error chapter, as quoted by users"

# Bit 0 of the register is set with any error; only the further bits are listed (CiA 301, 0x1001).
_ROWS: Final = (
    _row(0x1000, RegisterBit.GENERIC, _DISABLE, "generic error"),
    _row(0x2310, RegisterBit.CURRENT, _DISABLE, "over-current"),
    _row(0x3210, RegisterBit.VOLTAGE, _DISABLE, "over-voltage"),
    _row(
        0x3220,
        RegisterBit.VOLTAGE,
        _DISABLE,
        "under-voltage",
        provenance=Provenance.PROVEN,
        source="recorded at loss of power (code and register); reaction by analogy",
    ),
    _row(0x4210, RegisterBit.TEMPERATURE, _DISABLE, "over-temperature"),
    _row(0x5113, RegisterBit.VOLTAGE, _DISABLE, "5 V supply too low"),
    _row(0x5114, RegisterBit.VOLTAGE, _DISABLE, "supply of the output stage too low", provenance=_ASSUMED),
    _row(0x6100, _PROFILE, _DISABLE, "internal software error"),
    _row(0x6320, _PROFILE, _DISABLE, "software parameters contradict each other"),
    _row(0x7320, _PROFILE, _DISABLE, "position sensor: position no longer valid"),
    _row(0x8110, _COMMUNICATION, _STOP, "CAN overrun: object lost"),
    _row(0x8111, _COMMUNICATION, _STOP, "CAN overrun"),
    _row(0x8120, _COMMUNICATION, _STOP, "CAN error passive", Recovery.RESET_COMMUNICATION),
    _row(0x8130, _COMMUNICATION, _STOP, "heartbeat or node guarding failed; reaction chosen by 0x6007"),
    _row(0x8150, _COMMUNICATION, _NONE, "someone else sends with the drive's own COB-ID"),
    _row(0x81FD, _COMMUNICATION, _STOP, "CAN bus off"),
    _row(0x81FE, _COMMUNICATION, _STOP, "CAN receive queue overrun"),
    _row(0x81FF, _COMMUNICATION, _STOP, "CAN transmit queue overrun"),
    _row(0x8210, _COMMUNICATION, _STOP, "receive PDO shorter than its mapping"),
    _row(0x8611, _PROFILE, _STOP, "following error larger than 0x6065"),
    _row(0xFF01, _MAKER, _DISABLE, "hall sensor"),
    _row(0xFF02, _MAKER, _DISABLE, "encoder index missing or spurious"),
    _row(0xFF03, _MAKER, _DISABLE, "encoder resolution does not fit"),
    _row(0xFF04, _MAKER, _DISABLE, "hall sensor not found", Recovery.RESET_NODE),
    _row(0xFF06, _MAKER, _STOP, "negative limit switch"),
    _row(0xFF07, _MAKER, _STOP, "positive limit switch"),
    _row(0xFF08, _MAKER, _STOP, "hall angle not detected"),
    _row(0xFF09, _MAKER, _STOP, "position beyond the software limits 0x607D"),
    _row(0xFF0A, _MAKER, _DISABLE, "position sensor breach"),
    _row(0xFF0B, _PROFILE, _DISABLE, "system overloaded"),
    _row(0xFF0C, _PROFILE, _STOP, "interpolated position mode", provenance=_ASSUMED, source=LIBRARY),
    _row(0xFF0D, _PROFILE, _DISABLE, "identification for tuning", provenance=_ASSUMED, source=LIBRARY),
    _row(0xFF0F, _PROFILE, _DISABLE, "gear scaling factor", provenance=_ASSUMED, source=_NOTES),
    _row(0xFF10, _PROFILE, _DISABLE, "controller gain", provenance=_ASSUMED, source=_NOTES),
    _row(0xFF11, _PROFILE, _DISABLE, "main sensor direction", provenance=_ASSUMED, source=_NOTES),
    _row(0xFF12, _PROFILE, _DISABLE, "auxiliary sensor direction", provenance=_ASSUMED, source=_NOTES),
)

EMERGENCIES: Final[Mapping[int, Emergency]] = MappingProxyType({row.code: row for row in _ROWS})
"""Every error by its code."""
