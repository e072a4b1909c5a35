"""Values of objects as people write and read them: decimal, hexadecimal, with a unit, or by name.

The bounds of a value are the drive's, which refuses one out of range.
"""

import re
from collections.abc import Mapping
from decimal import Decimal
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.epos2.commissioning.client import CommissioningError
from firmware_bridge.families.epos2.commissioning.names import squashed
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.families.epos2.wire.modes import Mode

LONGEST_WRITE: Final = 4
"""Most bytes that are written in one go on every link."""
_SIGNATURES: Final = {"save": 0x65766173, "load": 0x64616F6C}
_WORDS: Final[Mapping[Address, Mapping[str, int]]] = MappingProxyType(
    {
        od.MODE: {squashed(mode.name): int(mode) for mode in Mode},
        Address(0x1010, 1): {"save": _SIGNATURES["save"]},
        **{Address(0x1011, sub): {"load": _SIGNATURES["load"]} for sub in (1, 4, 5)},
    }
)
"""Values that may be written by name."""
_UNITS: Final[Mapping[str, Mapping[str, Decimal]]] = {
    "mA": {"A": Decimal(1000)},
    "mV": {"V": Decimal(1000)},
    "ms": {"s": Decimal(1000)},
    "us": {"ms": Decimal(1000), "s": Decimal(1_000_000)},
    "100 ms": {"ms": Decimal("0.01"), "s": Decimal(10)},
    "100 us": {"us": Decimal("0.01"), "ms": Decimal(10)},
}
"""An object's unit, and others that a value may have, with the object's units in one of them."""
_NUMBER: Final = re.compile(
    r"(?P<sign>[+-]?)(?:(?P<hex>0x[0-9a-f]+)|(?P<number>\d+(?:\.\d+)?))\s*(?P<unit>\D.*)?", re.IGNORECASE
)


class ValueTextError(CommissioningError):
    """A value that cannot be made of this text."""


def size_of_write(address: Address, size: int | None) -> int:
    """Return how many bytes to write: the requested size, or the object's own; ValueTextError."""
    row = ANY_TYPE.get(address)
    own = LONGEST_WRITE if row is None else row.type.size
    if size is None and not 0 < own <= LONGEST_WRITE:
        length = f"{own} bytes" if own else "no fixed length"
        raise ValueTextError(
            f"{ANY_TYPE.called(address)} has {length}; values of up to {LONGEST_WRITE} can be written"
        )
    return own if size is None else size


def parse(address: Address, text: str, size: int | None = None) -> bytes:
    """Return the bytes to write, low byte first, of a text as `500`, `0x1F4`, `-3`, `500rpm` or `save`.

    `size` in bytes overrides the object's own. ValueTextError where the text, its unit or its size cannot be.
    """
    length = size_of_write(address, size)
    row = ANY_TYPE.get(address)
    number = _WORDS.get(address, {}).get(squashed(text))
    if number is None:
        number = _number(address, text.strip(), row)
    bits = 8 * length
    signed = row is not None and row.type.signed
    lowest = -(1 << bits - 1) if signed or row is None else 0
    highest = (1 << bits - signed) - 1
    if text.strip().lower().startswith("0x") and number < 1 << bits:
        highest = number  # hexadecimal digits are the bits themselves, also of a negative number
    if not lowest <= number <= highest:
        raise ValueTextError(
            f"'{text}' does not fit {ANY_TYPE.called(address)}: {length} bytes hold {lowest} to {highest}"
        )
    # Two's complement, and little-endian, as all numbers of CiA 301.
    return (number & (1 << bits) - 1).to_bytes(length, "little")


def _number(address: Address, text: str, row: ObjectRow | None) -> int:
    found = _NUMBER.fullmatch(text)
    if found is None:
        named = ", ".join(_WORDS.get(address, {}))
        kinds = f"a number or one of: {named}" if named else "a number, as 500, 0x1F4 or with its unit"
        raise ValueTextError(f"'{text}' is no value for {ANY_TYPE.called(address)}; give {kinds}")
    unit = (found["unit"] or "").strip()
    # Decimal and not float: 0.1 shall be a whole number of its smaller unit.
    magnitude = Decimal(int(found["hex"], 16)) if found["hex"] else Decimal(found["number"])
    scaled = magnitude * _factor(address, text, unit, row)
    if scaled != scaled.to_integral_value():
        wanted = "" if row is None or not row.unit else f" {row.unit}"
        raise ValueTextError(
            f"'{text}' is not a whole number of{wanted or ' steps'} for {ANY_TYPE.called(address)}"
        )
    return int(scaled) * (-1 if found["sign"] == "-" else 1)


def _factor(address: Address, text: str, unit: str, row: ObjectRow | None) -> Decimal:
    own = "" if row is None else row.unit
    unit = unit.removeprefix("x ")  # before a unit that begins with a number of its own
    if unit in {"", own}:
        return Decimal(1)
    others = _UNITS.get(own, {})
    if unit not in others:
        known = ", ".join((own, *others)) if own else "no unit"
        raise ValueTextError(f"'{text}' has the wrong unit: {ANY_TYPE.called(address)} is in {known}")
    return others[unit]
