"""The objects of a family's CANopen devices as people read them: names, units, values and their bits."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.family import families


@dataclass(frozen=True, slots=True)
class Dictionary:
    """One family's dictionary, of all its types."""

    vendor: int
    """The maker's number, 0x1018:1."""
    rows: Mapping[Address, ObjectRow]
    pdos: int
    """Number of its PDOs in each direction."""
    called: Callable[[Address], str]
    """Return index, sub-index and name."""
    decode: Callable[[Address, bytes], int | str]
    """Return a number, text, or bytes in hexadecimal."""
    unit_of: Callable[[Address], str]
    mode_of: Callable[[int], IntEnum | None]
    """Return the mode of a value of 0x6060."""
    words: Callable[[Address, int | str, IntEnum | None], tuple[str, ...]]
    """Return what the bits of a value stand for, in a mode."""


NOTHING: Final = Dictionary(
    0,
    {},
    0,
    str,
    lambda _address, raw: raw.hex(" ").upper(),
    lambda _address: "",
    lambda _value: None,
    lambda _address, _value, _mode: (),
)
"""The dictionary of a device of which nothing is known."""


@cache
def dictionaries() -> Mapping[str, Dictionary]:
    """Return the dictionaries of the installed families, by the families' names."""
    return {family.name: family.dictionary for family in families() if family.dictionary is not None}
