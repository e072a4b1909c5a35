"""CiA 301's data types, with their bytes on the wire, and the access that a client has to an object."""

from enum import Enum


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
