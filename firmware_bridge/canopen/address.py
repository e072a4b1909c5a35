"""The address of an object in a device's dictionary."""

from typing import NamedTuple


class Address(NamedTuple):
    """Address of an object in the dictionary; a tuple, because every access hashes one."""

    index: int  # type: ignore[assignment] # the standard's word; no one searches an address
    subindex: int = 0

    def __str__(self) -> str:
        """Write it as the manuals do: 0x6040 or 0x1018:01."""
        return f"0x{self.index:04X}" if self.subindex == 0 else f"0x{self.index:04X}:{self.subindex:02X}"
