"""The shape of one object's row: type, access, range, default, and the reliability of each."""

from dataclasses import dataclass
from enum import Enum

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import Access, DataType


class Provenance(Enum):
    """Reliability of a fact, by its source."""

    PROVEN = "proven"
    """From the maker's EDS, or recorded from a device."""
    DOCUMENTED = "documented"
    """From a document on the device, from its maker's library, or from the standard that it claims."""
    BY_ANALOGY = "by analogy"
    """From a document on a sister device."""
    ASSUMED = "assumed"
    """Nothing found; a choice that may change."""


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
    source: str = ""
    provenance: Provenance = Provenance.PROVEN
    """Of existence, type, access and range."""
    default_source: str = ""
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
