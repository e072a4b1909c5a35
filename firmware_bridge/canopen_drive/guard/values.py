"""The permitted values of one object."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType


@dataclass(frozen=True, slots=True)
class Bits:
    """Any of these bits, and no other."""

    mask: int

    def __contains__(self, value: int) -> bool:
        # A bit outside the mask would switch an output that the robot file does not name.
        return not value & ~self.mask


@dataclass(frozen=True, slots=True)
class Values:
    """Permitted values of one object: a range, a few values, or some bits."""

    type: DataType
    allowed: range | tuple[int, ...] | Bits

    def refuses(self, address: Address, raw: bytes) -> str | None:
        """Return why these bytes may not be written, or None."""
        if len(raw) != self.type.size:
            return f"{address} written with {len(raw)} bytes, it has {self.type.size}"
        value = self.type.decode(raw)
        return None if value in self.allowed else f"{address} set to {value}, allowed is {self._shown()}"

    def _shown(self) -> str:
        if isinstance(self.allowed, range):
            return f"{self.allowed.start} to {self.allowed.stop - 1}"
        if isinstance(self.allowed, Bits):
            return f"the bits 0x{self.allowed.mask:04X}"
        return " or ".join(str(value) for value in self.allowed)


Writes: TypeAlias = Mapping[Address, Values]


def exactly(kind: DataType, *values: int) -> Values:
    """Return these values, and no other."""
    return Values(kind, values)


def within(kind: DataType, low: int, high: int) -> Values:
    """Return the values from one to another, both included."""
    return Values(kind, range(low, high + 1))
