"""The object dictionary of each type: the 70/10's table, and the type's differences with their source.

A type without a row here is not known to differ, for want of its EDS.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.epos2.wire.objects import ROWS
from firmware_bridge.families.epos2.wire.rows import EDS, row

EDS_50_5: Final = "maxon EDS, EPOS2 50/5 (347717), software 2126h, hardware 6322h"


_U16: Final = DataType.UNSIGNED16


def _own(known: ObjectRow) -> ObjectRow:
    found = replace(known, source=EDS_50_5)
    return replace(found, default_source=EDS_50_5) if known.default_source == EDS else found


@dataclass(frozen=True, slots=True)
class Difference:
    """The objects of one hardware version."""

    source: str
    own: tuple[ObjectRow, ...] = ()
    """Objects that the 70/10 has not."""
    absent: frozenset[Address] = frozenset()
    """Objects of the 70/10 that it has not."""
    defaults: Mapping[Address, int] = field(default_factory=lambda: MappingProxyType({}))
    """Other defaults."""


DIFFERENCES: Final[Mapping[int, Difference]] = MappingProxyType(
    {
        0x6322: Difference(
            EDS_50_5,
            own=(
                _own(row(0x2070, 10, "Configuration of Digital Input10", _U16, Access.RW, default=6)),
                _own(row(0x207E, 0, "Analog Output 1", _U16, Access.RWW, mapped=True)),
            ),
            absent=frozenset({Address(0x202E, 12)}),
            defaults=MappingProxyType(
                {Address(0x2070, 0): 10, Address(0x2071, 2): 0xE3C7, Address(0x202E, 0): 11}
            ),
        )
    }
)
"""Differences by hardware version (0x2003:2)."""


@cache
def objects_of(hardware: int | None = None) -> ObjectDictionary:
    """Return the object dictionary of a type by its hardware version; without one, of the 70/10."""
    # Without an EDS of its own a type counts as the 70/10.
    found = DIFFERENCES.get(hardware or 0)
    if found is None:
        return ObjectDictionary(ROWS)
    return ObjectDictionary((*(row for row in ROWS if row.address not in found.absent), *found.own))


ANY_TYPE: Final = ObjectDictionary(
    row for hardware in (None, *DIFFERENCES) for row in objects_of(hardware).values()
)
"""The objects of all types: what a client can name."""
