"""The EPOS2's errors: emergencies of the servo axis' findings, and what it does not carry out.

Sources: EPOS Firmware Specification, error handling (by analogy); option codes per CiA 402.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.option_codes import FAULT_REACTION, ErrorReaction
from emulators.drive.supervision import Supervision, Watch
from emulators.epos2.control import enable_checks
from emulators.epos2.control.sensing import ABSOLUTE
from emulators.servo import axis as servo
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire import emergency
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES

WATCHES: Final = (
    Watch(servo.OVER_CURRENT, emergency.OVER_CURRENT),
    Watch(servo.OVER_VOLTAGE, emergency.OVER_VOLTAGE),
    Watch(servo.UNDER_VOLTAGE, emergency.UNDER_VOLTAGE),
    Watch(servo.FOLLOWING_ERROR, emergency.FOLLOWING_ERROR_TOO_LARGE),
    Watch(servo.OVER_TEMPERATURE, emergency.OVER_TEMPERATURE),
    Watch(servo.LOGIC_SUPPLY_LOW, emergency.LOGIC_SUPPLY),
    Watch(servo.GATE_SUPPLY_LOW, emergency.OUTPUT_STAGE_SUPPLY),
    Watch(servo.ENCODER_BROKEN, emergency.SENSOR_BREACH, absolute=emergency.SENSOR_POSITION),
    Watch(servo.INDEX_LOST, emergency.INDEX),
    Watch(servo.INDEX_DISTANCE_WRONG, emergency.ENCODER_RESOLUTION),
    Watch(servo.HALL_IMPOSSIBLE, emergency.HALL_SENSOR, measuring=emergency.HALL_NOT_FOUND),
    Watch(servo.HALL_ANGLE_APART, emergency.HALL_ANGLE),
    Watch(servo.ENCODER_AGAINST_MOTOR, emergency.MAIN_SENSOR_DIRECTION),
    Watch(servo.AUXILIARY_AGAINST_MAIN, emergency.AUXILIARY_SENSOR_DIRECTION),
    Watch(servo.POSITION_LIMIT_PASSED, emergency.POSITION_LIMIT),
)
"""Watched findings of the axis, with their emergencies.

Assumed: a cut cable is a position sensor breach (FF0A) with an incremental encoder, and a position that is no
longer valid (7320) with one that reports a position; three hall sensors that all show the same are FF04 while
the drive looks for its commutation and FF01 later.
"""

POSITION_LOST: Final = frozenset(
    {emergency.SENSOR_POSITION, emergency.INDEX, emergency.ENCODER_RESOLUTION, emergency.SENSOR_BREACH}
)
"""Emergencies after which the position is no longer referenced (assumed: those of the encoder)."""

NOT_CARRIED_OUT: Final[Mapping[Address, int]] = MappingProxyType(
    {
        Address(0x2400, 3): emergency.IDENTIFICATION,
        Address(0x2410, 1): emergency.IDENTIFICATION,
        Address(0x2FFF, 1): emergency.GENERIC,
    }
)
"""Objects that start what the emulation does not have, and the emergency in which the start ends.

Assumed: the drive answers as one whose identification of the motor, or whose download of firmware, has failed
at its beginning. Nothing moves: an identification would send a current through the motor.
"""
SETPOINTS_IN_A_MILLISECOND: Final = 8
"""Limit of new target values within one ms, above which the drive lacks the resources for them."""


FAULT_OPTIONS: Final[Mapping[int, ErrorReaction]] = MappingProxyType(
    {-1: ErrorReaction.NONE, **FAULT_REACTION}
)
"""0x605E, for the errors that allow a ramp; -1 is uncertain. Others count as the default, 2 (assumed)."""


def _contradiction(store: ObjectStore, state: PowerState) -> int | None:
    """Return the emergency of the settings in Refresh, which no command leaves."""
    return enable_checks.found(store) if state is PowerState.REFRESH else None


SUPERVISION: Final = Supervision(
    watches=WATCHES,
    emergencies=EMERGENCIES,
    fault_options=FAULT_OPTIONS,
    position_lost=POSITION_LOST,
    contradiction=_contradiction,
    contradicts=enable_checks.stands,
    absolute=lambda store: store.get(at.SENSOR_TYPE) in ABSOLUTE,
)
