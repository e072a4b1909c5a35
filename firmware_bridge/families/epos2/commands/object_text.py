"""Output of objects: one line for people, one record for programs."""

import re
from typing import Any, Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import meaning_of
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.commissioning.job import JobError, RefusedError
from firmware_bridge.families.epos2.commissioning.names import name_of
from firmware_bridge.families.epos2.commissioning.reading import Reading
from firmware_bridge.families.epos2.commissioning.words import WORDS
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE

_SIMPLE: Final = re.compile(r"[A-Za-z/]+")
"""Units as people say them: rpm, mA, pulses/turn."""
_PLAIN: Final = frozenset({od.MODE, od.MODE_DISPLAY})
"""Objects whose numbers are decoded, and are no bits."""


def object_line(reading: Reading, address: Address) -> str:
    """Return one line: address, name, value with unit, decoded text."""
    return f"{address!s:<9}  {name_of(address):<34}  {value_text(reading, address)}".rstrip()


def value_text(reading: Reading, address: Address) -> str:
    """Return a value with its unit, or decoded with its bits, or the reason why there is none."""
    raw = reading.found.get(address)
    if isinstance(raw, JobError):
        return f"- {raw.problem}"
    value = reading.value(address)
    if raw is None or value is None:
        return "-"
    decoded = WORDS.words(address, value, reading.mode)
    if not decoded:
        return f"{value}{_unit(address)}"
    number = f"{value}" if address in _PLAIN else f"0x{int.from_bytes(raw, 'little'):0{2 * len(raw)}X}"
    return f"{number}  {', '.join(decoded)}"


def object_record(reading: Reading, address: Address) -> dict[str, Any]:
    """Return the content of `line` for JSON; `value` or `error` is there, not both."""
    row = ANY_TYPE.get(address)
    found: dict[str, Any] = {
        "index": f"0x{address.index:04X}",
        "subindex": address.subindex,
        "name": name_of(address),
        "type": "" if row is None else row.type.name,
    }
    raw = reading.found.get(address)
    if isinstance(raw, bytes):
        value = reading.value(address)
        decoded = () if value is None else WORDS.words(address, value, reading.mode)
        found |= {"value": value, "raw": raw.hex(), "unit": ANY_TYPE.unit_of(address), "words": list(decoded)}
    elif isinstance(raw, RefusedError):
        found["error"] = {"code": f"0x{raw.code:08X}", "text": meaning_of(raw.code)}
    elif raw is not None:
        found["error"] = {"code": "", "text": raw.problem}
    return found


def _unit(address: Address) -> str:
    """Return an object's unit behind a number; a unit that is a number itself is set apart."""
    unit = ANY_TYPE.unit_of(address)
    if not unit:
        return ""
    return f" {unit}" if _SIMPLE.fullmatch(unit) else f" x {unit}"
