"""Settings that contradict each other: the drive refuses to be enabled with them, by an emergency.

Assumed: no document gives the conditions of FF0F and FF10, only their names. A dual loop (0x2220) divides by
the gear ratio 0x2230, which must be one; and it multiplies the gains of the position regulator with it, which
must stay numbers of 16 bits.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.control.sensing import CONTROLLER_STRUCTURE
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire import emergency

GEAR_NUMERATOR: Final = Address(0x2230, 1)
GEAR_DENOMINATOR: Final = Address(0x2230, 2)
WIDEST_GAIN: Final = 0x7FFF


def _no_ratio(store: ObjectStore) -> bool:
    return _dual(store) and 0 in (store.get(GEAR_NUMERATOR), store.get(GEAR_DENOMINATOR))


def _gains_too_large(store: ObjectStore) -> bool:
    if not _dual(store) or _no_ratio(store):
        return False
    # Compared as products of integers: a rounded ratio could pass a gain of 0x8000, one too many for INT16.
    largest = max(abs(store.get(gain)) for gain in (at.POSITION_P, at.POSITION_I, at.POSITION_D))
    return largest * store.get(GEAR_NUMERATOR) > WIDEST_GAIN * store.get(GEAR_DENOMINATOR)


def _dual(store: ObjectStore) -> bool:
    return store.get(CONTROLLER_STRUCTURE) != 0


CHECKS: Final[Mapping[int, Callable[[ObjectStore], bool]]] = MappingProxyType(
    {emergency.GEAR_SCALING: _no_ratio, emergency.CONTROLLER_GAIN: _gains_too_large}
)
"""Checks for contradicting settings, by the emergency that each of them causes."""


def found(store: ObjectStore) -> int | None:
    """Return the first emergency that the settings stand for."""
    return next((code for code, stands in CHECKS.items() if stands(store)), None)


def stands(store: ObjectStore, code: int) -> bool:
    """Return whether an emergency's settings still contradict each other."""
    return code in CHECKS and CHECKS[code](store)
