"""Values that the drive refuses although the EDS gives no range for them: one row per object.

It refuses to know refusals that depend on a state; motion control, PDOs and memory keep their own.
"""

from collections.abc import Collection
from dataclasses import dataclass
from functools import partial
from typing import Final

from emulators.epos2.modes.homing_methods import METHODS
from emulators.epos2.objects.device_profile import BIT_RATE, BIT_RATES
from emulators.epos2.objects.store import ObjectStore
from firmware_bridge.wire.abort import AbortCode, SdoAbort
from firmware_bridge.wire.canopen import FIRST_NODE, LAST_NODE, TIME_STAMP
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.functions import INPUT_PINS, OUTPUT_PINS, InputFunction, OutputFunction
from firmware_bridge.wire.epos2.rows import (
    APPLICATION_NOTES,
    ASSUMPTION,
    EDS,
    FIRMWARE_SPECIFICATION,
    LIBRARY,
    Provenance,
)

_INTERPOLATION: Final = "application note Interpolation Position Mode, December 2008, p. 11"
_ANALOGY: Final = Provenance.BY_ANALOGY
_DOCUMENTED: Final = Provenance.DOCUMENTED


@dataclass(frozen=True, slots=True)
class ValueRule:
    """An object and the only values that it takes; others get 0x06090030."""

    address: Address
    allowed: Collection[int]
    provenance: Provenance = _ANALOGY
    source: str = FIRMWARE_SPECIFICATION


RULES: Final = (
    ValueRule(Address(0x1012), (TIME_STAMP,), _DOCUMENTED, _INTERPOLATION),
    ValueRule(Address(0x2000), range(FIRST_NODE, LAST_NODE + 1)),
    ValueRule(BIT_RATE, tuple(BIT_RATES), _DOCUMENTED, LIBRARY),
    *(ValueRule(pin, tuple(InputFunction)) for pin in INPUT_PINS),
    *(ValueRule(pin, tuple(OutputFunction)) for pin in OUTPUT_PINS),
    ValueRule(Address(0x2012), range(1, 1 << 16), Provenance.ASSUMED, ASSUMPTION),
    ValueRule(Address(0x2014), range(5), _DOCUMENTED, APPLICATION_NOTES),
    ValueRule(Address(0x2074, 2), range(3), _DOCUMENTED, APPLICATION_NOTES),
    ValueRule(Address(0x2074, 3), range(3), _DOCUMENTED, APPLICATION_NOTES),
    ValueRule(at.SENSOR_TYPE, (1, 2, 3, 4, 6, 7, 8), _DOCUMENTED, LIBRARY),
    ValueRule(at.ABORT_CONNECTION_OPTION, range(4)),
    ValueRule(at.SHUTDOWN_OPTION, range(2)),
    ValueRule(at.DISABLE_OPTION, range(2)),
    ValueRule(at.FAULT_REACTION_OPTION, range(-1, 3)),
    ValueRule(Address(0x2300, 3), range(1, 1 << 16), Provenance.ASSUMED, ASSUMPTION),
    ValueRule(Address(0x2300, 4), range(2), Provenance.ASSUMED, ASSUMPTION),
    ValueRule(at.MOTION_PROFILE_TYPE, range(2), _DOCUMENTED, EDS),
    ValueRule(Address(0x6089), (0,)),
    ValueRule(Address(0x608A), (0xAC,)),
    ValueRule(Address(0x608B), (0,)),
    ValueRule(Address(0x608C), (0xA4,)),
    ValueRule(Address(0x608D), (0,)),
    ValueRule(Address(0x608E), (0xA4,)),
    ValueRule(at.HOMING_METHOD, tuple(METHODS)),
    ValueRule(at.MOTOR_TYPE, (1, 10, 11), _DOCUMENTED, LIBRARY),
)


def keep(store: ObjectStore) -> None:
    """Make the store refuse what the rules refuse."""
    for rule in RULES:
        store.on_write(rule.address, partial(_check, rule))


def _check(rule: ValueRule, value: int) -> None:
    if value not in rule.allowed:
        raise SdoAbort(AbortCode.RANGE, rule.address)
