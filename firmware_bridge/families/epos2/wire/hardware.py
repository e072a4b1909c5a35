"""The types of EPOS2 by their hardware versions, as far as a source gives them.

Source: names of maxon's firmware files and users' drivers; that of the 70/10 was read from a device. No
source gives that of the 24/2.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

MAXON: Final = 0x000000FB
"""Vendor in 0x1018:1."""
TYPES: Final[Mapping[int, str]] = MappingProxyType(
    {
        0x6120: "EPOS2 Module 36/2",
        0x6220: "EPOS2 24/5",
        0x6320: "EPOS2 50/5",
        0x6322: "EPOS2 50/5",
        0x6420: "EPOS2 70/10",
    }
)
"""A type's name by its hardware version (0x2003:2), which is the product code's upper half (0x1018:2)."""
_VERSION_SHIFT: Final = 16


def alike(product_code: int) -> frozenset[int]:
    """Return the product codes of the same type, whatever its hardware version; at least this one."""
    application = product_code & (1 << _VERSION_SHIFT) - 1
    name = type_of(product_code)
    versions = [version for version in TYPES if name is not None and TYPES[version] == name]
    return frozenset({product_code, *(version << _VERSION_SHIFT | application for version in versions)})


def type_of(product_code: int) -> str | None:
    """Return the type of a product code; None for one that no source gives."""
    return TYPES.get(product_code >> _VERSION_SHIFT)


ENCODER_HZ: Final = 5_000_000
"""Highest frequency of an encoder's channel. Assumed for every type: no source at hand states it; an EPOS4
takes 6.25 MHz by its hardware reference."""


def too_fast(encoder_lines: int, rpm: float) -> str:
    """Return why no EPOS2 can count an encoder at this speed of the motor; empty where it can."""
    frequency = encoder_lines * rpm / 60.0
    if frequency <= ENCODER_HZ:
        return ""
    return (
        f"{encoder_lines} lines at {rpm:.0f} rpm are {frequency / 1e6:.3g} MHz a channel: an EPOS2 counts "
        f"{ENCODER_HZ / 1e6:g} MHz at most (assumed)"
    )
