"""Map from the servo axis' findings to emergencies, and from emergencies to reactions.

Sources: EPOS Firmware Specification, error handling (by analogy); option codes per CiA 402. It does not carry
out a reaction.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import or_
from types import MappingProxyType
from typing import Final

from emulators.canopen.option_codes import FAULT_REACTION, ErrorReaction
from emulators.epos2.control.sensing import ABSOLUTE
from emulators.servo import axis as servo
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen.emergency import FaultReaction, Recovery
from firmware_bridge.families.epos2.wire import emergency
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES


@dataclass(frozen=True, slots=True)
class Watch:
    """A flag of the axis and the emergency that it stands for."""

    flag: int
    code: int
    measuring: int = 0
    """The emergency in its place while the drive looks for its commutation, in Measure init."""
    absolute: int = 0
    """The emergency in its place with a sensor that reports a position."""

    def code_in(self, state: PowerState, sensor_type: int) -> int:
        """Return the emergency in this state, with this position sensor (0x2210:2)."""
        if self.measuring and state is PowerState.MEASURE_INIT:
            return self.measuring
        return self.absolute if self.absolute and sensor_type in ABSOLUTE else self.code


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

WATCHED: Final = reduce(or_, (watch.flag for watch in WATCHES))


def findings(flags: int, state: PowerState, sensor_type: int, reported: Collection[int]) -> tuple[int, ...]:
    """Return the emergencies that the axis' flags stand for, but for those that have been reported."""
    return tuple(
        code
        for watch in WATCHES
        if flags & watch.flag
        and (code := watch.code_in(state, sensor_type)) not in reported
        # FF04 is cured by a node reset only: the same three wires must not add FF01 to it.
        and watch.measuring not in reported
    )


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


def reaction_to(code: int, fault_option: int) -> ErrorReaction:
    """Return the reaction to an emergency; a code that the table does not know switches off."""
    row = EMERGENCIES.get(code)
    if row is None or row.reaction is FaultReaction.DISABLE:
        return ErrorReaction.DISABLE
    if row.reaction is FaultReaction.NONE:
        return ErrorReaction.NONE
    return FAULT_OPTIONS.get(fault_option, ErrorReaction.QUICK_STOP)


def curable(errors: Collection[int]) -> bool:
    """Return whether a fault reset is enough for all of them."""
    rows = (EMERGENCIES.get(code) for code in errors)
    return all(row is None or row.recovery is Recovery.FAULT_RESET for row in rows)


def left_by_communication_reset(errors: Collection[int]) -> tuple[int, ...]:
    """Return the errors without those that reset communication cures."""
    return tuple(
        code
        for code in errors
        if code not in EMERGENCIES or EMERGENCIES[code].recovery is not Recovery.RESET_COMMUNICATION
    )
