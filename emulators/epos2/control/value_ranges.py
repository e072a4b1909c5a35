"""Values that the drive refuses although the EDS gives no range for them: one row per object.

Refusals that depend on a state are not here; motion control, PDOs and memory keep their own.
"""

from collections.abc import Collection
from dataclasses import dataclass
from functools import partial
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.modes.homing_methods import METHODS
from emulators.epos2.objects.device_profile import BIT_RATE, BIT_RATES
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import FIRST_NODE, LAST_NODE, TIME_STAMP
from firmware_bridge.canopen.object_row import Provenance
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import (
    INPUT_PINS,
    OUTPUT_PINS,
    InputFunction,
    OutputFunction,
)
from firmware_bridge.families.epos2.wire.rows import (
    APPLICATION_NOTES,
    ASSUMPTION,
    EDS,
    FIRMWARE_SPECIFICATION,
    LIBRARY,
)

_INTERPOLATION: Final = "application note Interpolation Position Mode, December 2008, p. 11"
_ANALOGY: Final = Provenance.BY_ANALOGY
_DOCUMENTED: Final = Provenance.DOCUMENTED


@dataclass(frozen=True, slots=True)
class ValueRange:
    """An object and the only values that it takes; others get 0x06090030."""

    address: Address
    allowed: Collection[int]
    provenance: Provenance = _ANALOGY
    source: str = FIRMWARE_SPECIFICATION


GAINS: Final = (
    *(at.CURRENT_P, at.CURRENT_I),
    *(at.VELOCITY_P, at.VELOCITY_I),
    *(at.POSITION_P, at.POSITION_I, at.POSITION_D),
)
"""Signed in the EDS, without a range."""

VALUE_RANGES: Final = (
    ValueRange(Address(0x1012), (TIME_STAMP,), _DOCUMENTED, _INTERPOLATION),
    ValueRange(Address(0x2000), range(FIRST_NODE, LAST_NODE + 1)),
    ValueRange(BIT_RATE, tuple(BIT_RATES), _DOCUMENTED, LIBRARY),
    *(ValueRange(pin, tuple(InputFunction)) for pin in INPUT_PINS),
    *(ValueRange(pin, tuple(OutputFunction)) for pin in OUTPUT_PINS),
    ValueRange(Address(0x2012), range(1, 1 << 16), Provenance.ASSUMED, ASSUMPTION),
    ValueRange(Address(0x2014), range(5), _DOCUMENTED, APPLICATION_NOTES),
    ValueRange(Address(0x2074, 2), range(3), _DOCUMENTED, APPLICATION_NOTES),
    ValueRange(Address(0x2074, 3), range(3), _DOCUMENTED, APPLICATION_NOTES),
    ValueRange(at.SENSOR_TYPE, (1, 2, 3, 4, 6, 7, 8), _DOCUMENTED, LIBRARY),
    ValueRange(od.ABORT_CONNECTION_OPTION, range(4)),
    ValueRange(od.SHUTDOWN_OPTION, range(2)),
    ValueRange(od.DISABLE_OPTION, range(2)),
    ValueRange(od.FAULT_REACTION_OPTION, range(-1, 3)),
    ValueRange(Address(0x2300, 3), range(1, 1 << 16), Provenance.ASSUMED, ASSUMPTION),
    ValueRange(Address(0x2300, 4), range(2), Provenance.ASSUMED, ASSUMPTION),
    ValueRange(od.MOTION_PROFILE_TYPE, range(2), _DOCUMENTED, EDS),
    ValueRange(Address(0x6089), (0,)),
    ValueRange(Address(0x608A), (0xAC,)),
    ValueRange(Address(0x608B), (0,)),
    ValueRange(Address(0x608C), (0xA4,)),
    ValueRange(Address(0x608D), (0,)),
    ValueRange(Address(0x608E), (0xA4,)),
    ValueRange(od.HOMING_METHOD, tuple(METHODS)),
    ValueRange(od.MOTOR_TYPE, (1, 10, 11), _DOCUMENTED, LIBRARY),
    # A gain below 0 makes a regulator run away, a motor without poles does not turn, a move at 0 never ends.
    *(ValueRange(gain, range(1 << 15), Provenance.ASSUMED, ASSUMPTION) for gain in GAINS),
    ValueRange(at.POLE_PAIRS, range(1, 1 << 8), Provenance.ASSUMED, ASSUMPTION),
    ValueRange(od.PROFILE_VELOCITY, range(1, 1 << 32), Provenance.ASSUMED, ASSUMPTION),
)


def keep(store: ObjectStore) -> None:
    """Make the store refuse what lies outside."""
    for row in VALUE_RANGES:
        store.on_write(row.address, partial(_check, row))


def _check(row: ValueRange, value: int) -> None:
    if value not in row.allowed:
        raise SdoAbort(AbortCode.RANGE, row.address)
