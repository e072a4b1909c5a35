"""The object dictionary of one type of drive as a table: for people, as JSON, as a page."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from emulators.epos2.objects.device_profile import DeviceProfile
from emulators.epos2.objects.parameters import is_parameter
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.object_row import ObjectRow

HEADINGS: Final = (
    "object",
    "name",
    "type",
    "access",
    "PDO",
    "default",
    "min",
    "max",
    "unit",
    "kept",
    "known",
    "default known",
)
LINE: Final = ("object", "type", "access", "PDO", "name", "default")
NAME: Final = 4
"""Headings of a line on a terminal, of which the name may be cut."""
_SHORT: Final = {"UNSIGNED": "U", "INTEGER": "I", "VISIBLE_STRING": "string", "DOMAIN": "domain"}
_WIDE: Final = frozenset({DataType.UNSIGNED32, DataType.UNSIGNED64})


@dataclass(frozen=True, slots=True)
class ObjectEntry:
    """One object as this type of drive has it."""

    row: ObjectRow
    default: int | bytes
    low: int | None
    high: int | None

    @property
    def pdo(self) -> str:
        """PDOs that may carry it."""
        if self.row.transmittable:
            return "transmit"
        return "receive" if self.row.receivable else "no"

    @property
    def default_text(self) -> str:
        """The default for people."""
        if isinstance(self.default, bytes):
            return self.default.decode("ascii")
        if self.row.node_added:
            base = self.row.default
            return f"{base:#x} + node" if isinstance(base, int) and base else "node"
        # COB-IDs and identities in hexadecimal; a number with a unit stays decimal.
        wide = self.row.type in _WIDE and self.default > 0xFFFF and not self.row.unit  # noqa: PLR2004
        return f"{self.default:#010x}" if wide else str(self.default)

    @property
    def short_type(self) -> str:
        """The type as its letter and width: U32 for UNSIGNED32."""
        name = self.row.type.name
        return next((name.replace(long, short) for long, short in _SHORT.items() if long in name), name)

    def line(self) -> tuple[str, ...]:
        """Return the texts of one line on a terminal, as `LINE` names them."""
        row = self.row
        pdo = {"transmit": "tx", "receive": "rx"}.get(self.pdo, "")
        default = f"{self.default_text} {row.unit}".rstrip()
        return str(row.address), self.short_type, row.access.value, pdo, row.name, default

    def matches(self, words: Sequence[str]) -> bool:
        """Return whether address or name have all of these words; case does not count."""
        text = f"{self.row.address} {self.row.name}".casefold()
        return all(word.casefold() in text for word in words)

    def cells(self) -> tuple[str, ...]:
        """Return the texts of one line, as `HEADINGS` names them."""
        row = self.row
        bounds = ("" if bound is None else str(bound) for bound in (self.low, self.high))
        return (
            str(row.address),
            row.name,
            row.type.name,
            row.access.value,
            self.pdo,
            self.default_text,
            *bounds,
            row.unit,
            "yes" if is_parameter(row) else "no",
            row.provenance.value,
            row.default_provenance.value,
        )


def entries(profile: DeviceProfile, node: int = 1) -> tuple[ObjectEntry, ...]:
    """Return every object of such a drive with this number, in the order of the addresses."""
    differing, bounds = profile.differing(node), profile.bounds()
    made = []
    for address, row in profile.objects.items():
        low, high = bounds.get(address, (row.minimum, row.maximum))
        default = differing.get(address, row.default_for(node))
        made.append(ObjectEntry(_marked(row, profile), default, low, high))
    return tuple(made)


def _marked(row: ObjectRow, profile: DeviceProfile) -> ObjectRow:
    """Return the row with the type's own figures and their provenance."""
    name = profile.field_of(row.address)
    if name is None:
        return row
    known = profile.known(name)
    row = replace(row, default_provenance=known.provenance, default_source=known.source)
    # The range, too, is the type's own: then its provenance is that of the profile's figure.
    if row.address in profile.bounds():
        return replace(row, provenance=known.provenance, source=known.source)
    return row


def as_json(profile: DeviceProfile, node: int = 1) -> str:
    """Return the table as JSON; numbers are numbers, a range that is the type's own is null."""
    return json.dumps([_as_record(entry) for entry in entries(profile, node)], indent=1)


def _as_record(entry: ObjectEntry) -> dict[str, object]:
    row = entry.row
    default = entry.default.decode("ascii") if isinstance(entry.default, bytes) else entry.default
    return {
        "index": row.address.index,
        "subindex": row.address.subindex,
        "name": row.name,
        "type": row.type.name,
        "access": row.access.value,
        "pdo": entry.pdo,
        "default": default,
        "min": entry.low,
        "max": entry.high,
        "unit": row.unit,
        "persistent": is_parameter(row),
        "provenance": row.provenance.value,
        "source": row.source,
        "default_provenance": row.default_provenance.value,
        "default_source": row.default_source,
        "note": row.note,
    }
