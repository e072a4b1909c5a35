"""Which finding of the servo axis is which emergency, and what the option codes make of a reaction.

Sources: EPOS Firmware Specification, error handling (by analogy); option codes per CiA 402. It refuses to
know how a reaction is carried out.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final

from emulators.servo import axis as servo
from firmware_bridge.wire.epos2 import emergency
from firmware_bridge.wire.epos2.emergency import EMERGENCIES, FaultReaction


@dataclass(frozen=True, slots=True)
class Watch:
    """A flag of the axis and the emergency that it stands for."""

    flag: int
    code: int


WATCHES: Final = (
    Watch(servo.OVER_CURRENT, emergency.OVER_CURRENT),
    Watch(servo.OVER_VOLTAGE, emergency.OVER_VOLTAGE),
    Watch(servo.UNDER_VOLTAGE, emergency.UNDER_VOLTAGE),
    Watch(servo.FOLLOWING_ERROR, emergency.FOLLOWING_ERROR_TOO_LARGE),
)

POSITION_LOST: Final = frozenset(
    {emergency.SENSOR_POSITION, emergency.INDEX, emergency.ENCODER_RESOLUTION, emergency.SENSOR_BREACH}
)
"""Emergencies after which the position is no longer referenced (ASSUME: those of the encoder)."""

WATCHED: Final = servo.OVER_CURRENT | servo.OVER_VOLTAGE | servo.UNDER_VOLTAGE | servo.FOLLOWING_ERROR


class Reaction(Enum):
    """How the motor is brought to rest before the fault state."""

    NONE = "only told"
    DISABLE = "power stage off at once"
    SLOW_DOWN = "ramp with 0x6084, then off"
    QUICK_STOP = "ramp with 0x6085, then off"


FAULT_OPTIONS: Final[Mapping[int, Reaction]] = MappingProxyType(
    {
        -1: Reaction.NONE,
        0: Reaction.DISABLE,
        1: Reaction.SLOW_DOWN,
        2: Reaction.QUICK_STOP,
    }
)
"""0x605E, for the errors that allow a ramp; -1 is uncertain. Others count as the default, 2 (ASSUME)."""

ABORT_OPTIONS: Final[Mapping[int, Reaction]] = MappingProxyType(
    {
        0: Reaction.NONE,
        2: Reaction.DISABLE,
        3: Reaction.QUICK_STOP,
    }
)
"""0x6007 for a lost connection; 1, and others, react as 0x605E says. Each but 0 ends in Fault."""


def reaction_to(code: int, fault_option: int) -> Reaction:
    """Return the reaction to an emergency; a code that the table does not know switches off."""
    row = EMERGENCIES.get(code)
    if row is None or row.reaction is FaultReaction.DISABLE:
        return Reaction.DISABLE
    if row.reaction is FaultReaction.NONE:
        return Reaction.NONE
    return FAULT_OPTIONS.get(fault_option, Reaction.QUICK_STOP)
