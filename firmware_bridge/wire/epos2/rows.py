"""The shape of one object's row: type, access, range, default, and the reliability of each.

The particular objects are in the tables `objects_*`.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Final

from firmware_bridge.wire.epos2.address import Address

EDS: Final = "maxon EDS, EPOS2 70/10, software 2126h"
DEVICE: Final = "EPOS Studio export of a real EPOS2 70/10"
APPLICATION_NOTES: Final = "EPOS2 Application Notes Collection, April 2013"
FIRMWARE_SPECIFICATION: Final = "EPOS Firmware Specification, April 2010 (EPOS1)"
LIBRARY: Final = "source of maxon's command library"
CIA_301: Final = "CiA 301"
ASSUMPTION: Final = "own assumption"


class Provenance(Enum):
    """Reliability of a fact, by its source."""

    PROVEN = "proven"
    """From maxon's EDS, or recorded from a device."""
    DOCUMENTED = "documented"
    """From a document on the EPOS2, from maxon's library, or from the standard that the device claims."""
    BY_ANALOGY = "by analogy"
    """From a document on a sister device."""
    ASSUMED = "assumed"
    """Nothing found; a choice that may change."""


class DataType(Enum):
    """A CiA 301 data type: its code in the EDS, its bytes (0: as many as it takes), its sign."""

    INTEGER8 = (0x0002, 1, True)
    INTEGER16 = (0x0003, 2, True)
    INTEGER32 = (0x0004, 4, True)
    UNSIGNED8 = (0x0005, 1, False)
    UNSIGNED16 = (0x0006, 2, False)
    UNSIGNED32 = (0x0007, 4, False)
    VISIBLE_STRING = (0x0009, 0, False)
    DOMAIN = (0x000F, 0, False)
    UNSIGNED64 = (0x001B, 8, False)

    def __init__(self, code: int, size: int, signed: bool) -> None:  # noqa: FBT001 - one row of the table
        self.code = code
        self.size = size
        self.signed = signed
        self.bits = 8 * size
        """Length in bits, as in a PDO mapping entry."""
        # Two's complement: a negative number is its low bits.
        self._mask = (1 << self.bits) - 1

    @property
    def lowest(self) -> int:
        """The smallest number that the type holds."""
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def highest(self) -> int:
        """The largest number that the type holds."""
        return (1 << (self.bits - self.signed)) - 1

    def encode(self, value: int) -> bytes:
        """Return the bytes on the wire, low byte first; a number that does not fit wraps as in a register."""
        return (value & self._mask).to_bytes(self.size, "little")

    def decode(self, raw: bytes) -> int:
        """Return the number in `raw`, which has the type's size."""
        return int.from_bytes(raw, "little", signed=self.signed)


class Access(Enum):
    """Access of a bus client to an object."""

    RO = "ro"
    CONST = "const"
    WO = "wo"
    RW = "rw"
    RWW = "rww"
    """Read and write; where mappable, into receive PDOs."""

    def __init__(self, word: str) -> None:
        self.readable = word != "wo"
        """True where an upload is allowed."""
        self.writable = word not in {"ro", "const"}
        """True where a download is allowed."""


@dataclass(frozen=True, slots=True)
class ObjectRow:
    """One object: where, what, who may touch it, between which bounds, and from which source."""

    address: Address
    name: str
    type: DataType
    access: Access
    mappable: bool = False
    default: int | bytes = 0
    """Value after power-on without saved parameters; bytes for strings and domains."""
    minimum: int | None = None
    maximum: int | None = None
    unit: str = ""
    node_added: bool = False
    """The node's number is added to the default."""
    source: str = EDS
    provenance: Provenance = Provenance.PROVEN
    """Of existence, type, access and range."""
    default_source: str = EDS
    default_provenance: Provenance = Provenance.PROVEN
    note: str = ""

    @property
    def transmittable(self) -> bool:
        """True where a transmit PDO may carry it; in the EDS `rww` is for receive PDOs only (CiA 306)."""
        return self.mappable and self.access is Access.RO

    @property
    def receivable(self) -> bool:
        """True where a receive PDO may carry it."""
        return self.mappable and self.access.writable

    @property
    def bounds(self) -> tuple[int, int]:
        """Smallest and largest number that a client may write; the type's own where the EDS gives none."""
        low = self.type.lowest if self.minimum is None else self.minimum
        high = self.type.highest if self.maximum is None else self.maximum
        return low, high

    def default_for(self, node_id: int) -> int | bytes:
        """Return the default of the object in the drive with this number."""
        if isinstance(self.default, bytes):
            return self.default
        # CiA 301: the predefined connection set adds the node's number to the COB-IDs.
        return self.default + node_id if self.node_added else self.default


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
        default_source=origin,
        default_provenance=trust,
        note=note,
    )


def count(index: int, entries: int, access: Access = Access.RO, name: str = "Number of Entries") -> ObjectRow:
    """Make the row of sub-index 0: how many entries, or the largest sub-index."""
    return row(index, 0, name, DataType.UNSIGNED8, access, default=entries)
