"""PDO contents: the mapping entry's 32 bits, and values packed side by side.

The objects that may be mapped are in the object dictionary.
"""

import struct
from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType

RECEIVE_PARAMETER: Final = 0x1400
RECEIVE_MAPPING: Final = 0x1600
TRANSMIT_PARAMETER: Final = 0x1800
TRANSMIT_MAPPING: Final = 0x1A00
"""First indexes of the PDOs' objects; one of each for every PDO."""
MOST_PDOS: Final = 512
"""Of each direction."""
MAX_ENTRIES: Final = 8
MAX_BITS: Final = 64

AT_SYNC_IF_CHANGED: Final = 0
EVERY_SYNC: Final = 1
SYNCHRONOUS: Final = range(241)
"""Transmission types that wait for SYNC: 0 for an event, 1 to 240 for that many of them."""
SAMPLED_AT_SYNC: Final = 252
"""Sent on request, with the values of the last SYNC."""
ON_REQUEST: Final = 253
ON_EVENT: Final = 254
"""Events are the maker's."""
ON_CHANGE: Final = 255
"""Events are the device profile's."""
EVENT_DRIVEN: Final = (ON_EVENT, ON_CHANGE)
RECEIVE_TYPES: Final = frozenset({*SYNCHRONOUS, *EVENT_DRIVEN})
TRANSMIT_TYPES: Final = RECEIVE_TYPES | {SAMPLED_AT_SYNC, ON_REQUEST}
"""Transmission types of CiA 301; 241 to 251 are reserved."""

_STRUCT_CODE: Final = {
    DataType.INTEGER8: "b",
    DataType.INTEGER16: "h",
    DataType.INTEGER32: "i",
    DataType.UNSIGNED8: "B",
    DataType.UNSIGNED16: "H",
    DataType.UNSIGNED32: "I",
    DataType.UNSIGNED64: "Q",
}


@dataclass(frozen=True, slots=True)
class MappingEntry:
    """One line of a PDO mapping: an object and its length in bits, as in 0x60400010."""

    address: Address
    bits: int

    def encode(self) -> int:
        """Return the 32 bits that are written to 0x1600 or 0x1A00."""
        # CiA 301: index in bits 16 to 31, sub-index in 8 to 15, length in bits in 0 to 7.
        return self.address.index << 16 | self.address.subindex << 8 | self.bits

    @classmethod
    def decode(cls, word: int) -> "MappingEntry":
        """Return the entry in 32 bits; every number is a valid one."""
        return cls(Address(word >> 16, word >> 8 & 0xFF), word & 0xFF)


class Layout:
    """The fields of one PDO, made once so that packing costs no parsing."""

    __slots__ = ("_fields", "_struct", "addresses", "size", "types")

    def __init__(self, *fields: tuple[Address, DataType]) -> None:
        """Lay the fields out in order, low byte first; ValueError when they fit no CAN frame."""
        self.addresses = tuple(address for address, _ in fields)
        self.types = tuple(kind for _, kind in fields)
        unpackable = [kind.name for kind in self.types if kind not in _STRUCT_CODE]
        if unpackable:
            raise ValueError(f"a PDO carries numbers only, not {', '.join(unpackable)}")
        self.size = sum(kind.size for kind in self.types)
        """Size of the payload in bytes."""
        if self.size * 8 > MAX_BITS:
            raise ValueError(f"{self.size * 8} bits in a PDO of at most {MAX_BITS}")
        # CiA 301: values follow each other without gaps, each with its low byte first.
        self._struct = struct.Struct("<" + "".join(_STRUCT_CODE[kind] for kind in self.types))
        shift = 0
        masks = []
        for kind in self.types:
            masks.append(((1 << kind.bits) - 1, shift))
            shift += kind.bits
        self._fields = tuple(masks)

    def entries(self) -> tuple[MappingEntry, ...]:
        """Return the mapping entries that make a device use this layout."""
        return tuple(
            MappingEntry(address, kind.bits) for address, kind in zip(self.addresses, self.types, strict=True)
        )

    def pack(self, *values: int) -> bytes:
        """Return the payload; a number that does not fit its field wraps as in a register."""
        try:
            return self._struct.pack(*values)
        except struct.error:
            # struct refuses what does not fit; a register keeps its low bits.
            return self._wrapped(values)

    def _wrapped(self, values: tuple[int, ...]) -> bytes:
        word = 0
        for value, (mask, shift) in zip(values, self._fields, strict=True):
            word |= (value & mask) << shift
        return word.to_bytes(self.size, "little")

    def unpack(self, payload: bytes) -> tuple[int, ...]:
        """Return the values; bytes beyond the layout are ignored, ValueError when some are missing."""
        if len(payload) < self.size:
            raise ValueError(f"a PDO of {len(payload)} bytes where {self.size} are mapped")
        return self._struct.unpack_from(payload)
