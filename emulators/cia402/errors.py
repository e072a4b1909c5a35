"""The servo's errors: emergencies of CiA 301 and CiA 402, and what it supervises.

Source: CiA 402-2, error codes. Assumed: the codes of the two limit switches,
which errors allow a ramp, and that each is cured by a fault reset.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.drive.shaft import Impossible
from emulators.drive.supervision import Supervision, Watch
from emulators.servo import axis as servo
from firmware_bridge.canopen.emergency import Emergency, FaultReaction, RegisterBit

OVER_CURRENT: Final = 0x2310
OVER_VOLTAGE: Final = 0x3210
UNDER_VOLTAGE: Final = 0x3220
OVER_TEMPERATURE: Final = 0x4310
NEGATIVE_LIMIT: Final = 0x5443
POSITIVE_LIMIT: Final = 0x5442
PARAMETER: Final = 0x6320
ENCODER: Final = 0x7305
CONNECTION_LOST: Final = 0x8130
FOLLOWING_ERROR: Final = 0x8611
REFERENCE_LIMIT: Final = 0x8612

_NONE, _OFF, _RAMP = FaultReaction.NONE, FaultReaction.DISABLE, FaultReaction.QUICK_STOP
_BUS: Final = RegisterBit.COMMUNICATION

EMERGENCIES: Final[Mapping[int, Emergency]] = MappingProxyType(
    {
        row.code: row
        for row in (
            Emergency(OVER_CURRENT, RegisterBit.CURRENT, _OFF, "over-current"),
            Emergency(OVER_VOLTAGE, RegisterBit.VOLTAGE, _OFF, "DC link over-voltage"),
            Emergency(UNDER_VOLTAGE, RegisterBit.VOLTAGE, _OFF, "DC link under-voltage"),
            Emergency(OVER_TEMPERATURE, RegisterBit.TEMPERATURE, _OFF, "over-temperature of the drive"),
            Emergency(NEGATIVE_LIMIT, RegisterBit.PROFILE, _RAMP, "negative limit switch"),
            Emergency(POSITIVE_LIMIT, RegisterBit.PROFILE, _RAMP, "positive limit switch"),
            Emergency(PARAMETER, RegisterBit.PROFILE, _RAMP, "parameter"),
            Emergency(ENCODER, RegisterBit.PROFILE, _OFF, "incremental encoder"),
            Emergency(0x8110, _BUS, _NONE, "CAN overrun"),
            Emergency(0x8120, _BUS, _NONE, "CAN error passive"),
            Emergency(CONNECTION_LOST, _BUS, _RAMP, "life guard or heartbeat"),
            Emergency(0x8150, _BUS, _NONE, "COB-ID collision"),
            Emergency(0x8210, _BUS, _NONE, "PDO too short"),
            Emergency(0x8250, _BUS, _RAMP, "PDO not received in time"),
            Emergency(FOLLOWING_ERROR, RegisterBit.PROFILE, _RAMP, "following error"),
            Emergency(REFERENCE_LIMIT, RegisterBit.PROFILE, _RAMP, "target outside the position limits"),
        )
    }
)
SUPPLY_LOW: Final = servo.UNDER_VOLTAGE
"""The axis' flag of a power stage without its supply."""
IMPOSSIBLE: Final = Impossible(outside=REFERENCE_LIMIT, too_far=PARAMETER)
SUPERVISION: Final = Supervision(
    watches=(
        Watch(servo.OVER_CURRENT, OVER_CURRENT),
        Watch(servo.OVER_VOLTAGE, OVER_VOLTAGE),
        Watch(servo.UNDER_VOLTAGE, UNDER_VOLTAGE),
        Watch(servo.OVER_TEMPERATURE, OVER_TEMPERATURE),
        Watch(servo.ENCODER_BROKEN, ENCODER),
    ),
    emergencies=EMERGENCIES,
    position_lost=frozenset({ENCODER}),
)
