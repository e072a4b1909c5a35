"""The objects of a family's CANopen devices as people read them: names, units, values and their bits."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from firmware_bridge.canopen.drive_words import DriveWords
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.family import families


@dataclass(frozen=True, slots=True)
class Dictionary:
    """One family's dictionary, of all its types."""

    vendor: int | None
    """The maker's number, 0x1018:1; None: of drives of any maker."""
    rows: ObjectDictionary
    pdos: int
    """Number of its PDOs in each direction."""
    words: DriveWords
    """What the bits of values stand for."""


@cache
def dictionaries() -> Mapping[str, Dictionary]:
    """Return the dictionaries of the installed families, by the families' names."""
    return {family.name: family.dictionary for family in families() if family.dictionary is not None}
