"""One row of a drive's set-up: an object, the value that it must have or is given, and why."""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.units import Nanoseconds

DRIVE_PROFILE: Final = "CiA 402"


@dataclass(frozen=True, slots=True)
class SetupObject:
    """One object: the value that it must have, or is given, and why."""

    address: Address
    type: DataType
    value: int
    name: str
    why: str
    source: str = DRIVE_PROFILE
    read_back: bool = False
    """Safety hangs on this value: it is read again after it was written."""
    also: frozenset[int] = frozenset()
    """Values that are as good."""
    mask: int | None = None
    """The bits that count where its value is read; None: all."""
    optional: bool = False
    """A drive without this object is as good."""
    awaited: Nanoseconds = 0
    """It is not written: the drive comes to this value by itself, within this time."""
    hint: str = ""
    """What a drive that refuses it is like, for people, and what to do."""

    def has(self, raw: bytes) -> bool:
        """Return whether this is the value, or as good."""
        if self.mask is not None and len(raw) == self.type.size:
            return self.type.decode(raw) & self.mask == self.value & self.mask
        return raw == self.raw or raw in {self.type.encode(value) for value in self.also}

    @property
    def raw(self) -> bytes:
        """The value as it stands on the wire."""
        return self.type.encode(self.value)

    @property
    def expected(self) -> str:
        """The name and the value for people, unsigned 32-bit values in hexadecimal as in the manuals."""
        return f"{self.name} {self.show(self.raw)}"

    def show(self, raw: bytes) -> str:
        """Write what came for this object."""
        if len(raw) != self.type.size:
            return f"{len(raw)} bytes {raw.hex(' ')}"
        value = self.type.decode(raw)
        return f"0x{value:08X}" if self.type is DataType.UNSIGNED32 else str(value)
