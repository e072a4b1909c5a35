"""Rows of the EPOS2's object table, as its EDS has them; the objects are in the tables `objects_*`."""

from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_row import ObjectRow, Provenance

EDS: Final = "maxon EDS, EPOS2 70/10, software 2126h"
DEVICE: Final = "EPOS Studio export of a real EPOS2 70/10"
APPLICATION_NOTES: Final = "EPOS2 Application Notes Collection, April 2013"
FIRMWARE_SPECIFICATION: Final = "EPOS Firmware Specification, April 2010 (EPOS1)"
LIBRARY: Final = "source of maxon's command library"
CIA_301: Final = "CiA 301"
ASSUMPTION: Final = "own assumption"


def row(
    index: int,
    subindex: int,
    name: str,
    kind: DataType,
    access: Access,
    *,
    default: int | None = None,
    low: int | None = None,
    high: int | None = None,
    unit: str = "",
    mapped: bool = False,
    read: int | bytes | None = None,
    standard: int | None = None,
    node: bool = False,
    note: str = "",
) -> ObjectRow:
    """Make a row of the EDS.

    Its default: the EDS's, else the value `read` from a real device, else that of the `standard`, else 0.
    """
    value: int | bytes
    if default is not None:
        value, origin, trust = default, EDS, Provenance.PROVEN
    elif read is not None:
        value, origin, trust = read, DEVICE, Provenance.PROVEN
    elif standard is not None:
        value, origin, trust = standard, CIA_301, Provenance.DOCUMENTED
    else:
        value, origin, trust = 0, ASSUMPTION, Provenance.ASSUMED
    if kind.size == 0 and isinstance(value, int):
        value = b""
    return ObjectRow(
        address=Address(index, subindex),
        name=name,
        type=kind,
        access=access,
        mappable=mapped,
        default=value,
        minimum=low,
        maximum=high,
        unit=unit,
        node_added=node,
        source=EDS,
        default_source=origin,
        default_provenance=trust,
        note=note,
    )


def count(index: int, entries: int, access: Access = Access.RO, name: str = "Number of Entries") -> ObjectRow:
    """Make the row of sub-index 0: how many entries, or the largest sub-index."""
    return row(index, 0, name, DataType.UNSIGNED8, access, default=entries)
