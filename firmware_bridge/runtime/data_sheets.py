"""The objects in an electronic data sheet or a device configuration file (CiA 306)."""

import configparser
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_row import ObjectRow

_OBJECT: Final = re.compile(r"(?i)([0-9a-f]{4})(?:sub([0-9a-f]{1,2}))?")
_NODE: Final = re.compile(r"(?i)\$nodeid\s*\+?\s*")
_MOST: Final = 8
_VARIABLES: Final = (2, 7)
"""Object types of CiA 306 with a value of their own: a domain, a variable."""
_TYPES: Final = {kind.code: kind for kind in DataType} | {1: DataType.UNSIGNED8, 0xA: DataType.DOMAIN}
"""By their codes; a boolean has a byte over SDO, and octets are as many as there are."""
_ACCESSES: Final = {access.value: access for access in Access} | {"rwr": Access.RW}


class SheetError(Exception):
    """A file that is none of its kind: every section and key, and what is wrong with it."""


@dataclass(frozen=True, slots=True)
class SheetValues:
    """Numbers by their objects, and the node that a configuration file names; 0 where it names none."""

    values: Mapping[Address, int]
    node: int


def configured(file: Path, rows: Mapping[Address, ObjectRow]) -> SheetValues:
    """Return each `ParameterValue` of a DCF of an object in these rows; SheetError."""
    nothing = "no ParameterValue of an object that is known is in it; is it an EDS?"
    return _read(file, rows, "parametervalue", nothing)


def defaults(file: Path, rows: Mapping[Address, ObjectRow]) -> SheetValues:
    """Return each `DefaultValue` of an EDS of an object in these rows; SheetError."""
    return _read(file, rows, "defaultvalue", "no DefaultValue of an object that is known is in it")


def objects(file: Path) -> tuple[ObjectRow, ...]:
    """Return the objects that an EDS describes, whatever they are; SheetError.

    Objects of a type without a size of its own in CiA 301's basic table (times, floats) are left out.
    """
    sections = _sections(file)
    found: list[ObjectRow] = []
    problems: list[str] = []
    for address, section in _objects(sections):
        given = sections[section]
        if int(given.get("objecttype", "7"), 0) not in _VARIABLES:
            continue
        kind = _TYPES.get(int(given.get("datatype", "0"), 0))
        access = _ACCESSES.get(given.get("accesstype", "").strip().lower())
        if access is None:
            problems.append(f"[{section}] AccessType '{given.get('accesstype', '')}' is none")
        if kind is None or access is None:
            continue
        try:
            found.append(_row(address, given, kind, access))
        except ValueError:
            problems.append(f"[{section}] a number cannot be read")
    if not found and not problems:
        problems.append("it describes no object; is it an EDS?")
    if problems:
        raise SheetError(f"{file}: {'; '.join(problems[:_MOST])}")
    return tuple(found)


def _row(address: Address, given: Mapping[str, str], kind: DataType, access: Access) -> ObjectRow:
    text = given.get("defaultvalue", "").strip()
    default: int | bytes
    default = text.encode("latin-1") if not kind.size else _in_type(kind, text)
    bounds = [given.get(key, "").strip() for key in ("lowlimit", "highlimit")]
    low, high = (_in_type(kind, bound) if bound and kind.size else None for bound in bounds)
    return ObjectRow(
        address,
        given.get("parametername", ""),
        kind,
        access,
        int(given.get("pdomapping", "0") or "0", 0) == 1,
        default,
        low,
        high,
        node_added=bool(_NODE.search(text)),
        source="its EDS",
    )


def _in_type(kind: DataType, text: str) -> int:
    value = _number(text, 0)
    # Data sheets write negative numbers as hexadecimal digits of the register.
    return value - (1 << kind.bits) if kind.lowest < 0 and value > kind.highest else value


def _read(file: Path, rows: Mapping[Address, ObjectRow], key: str, nothing: str) -> SheetValues:
    sections = _sections(file)
    node = _node(sections)
    found: dict[Address, int] = {}
    problems: list[str] = []
    for address, section in _objects(sections):
        text = sections[section].get(key, "").strip()
        row = rows.get(address)
        if not text or row is None or not row.type.size:
            continue
        try:
            value = _number(text, node)
        except ValueError:
            problems.append(f"[{section}] {text} is no number")
            continue
        # Data sheets write negative numbers as hexadecimal digits of the register.
        if row.type.lowest < 0 and value > row.type.highest:
            value -= 1 << row.type.bits
        if not row.type.lowest <= value <= row.type.highest:
            problems.append(f"[{section}] {text} does not fit {row.type.name}")
        found[address] = value
    if problems:
        more = f"; and {len(problems) - _MOST} more" if len(problems) > _MOST else ""
        raise SheetError(f"{file}: {'; '.join(problems[:_MOST])}{more}")
    if not found:
        raise SheetError(f"{file}: {nothing}")
    return SheetValues(found, node)


def _sections(file: Path) -> configparser.ConfigParser:
    # Without interpolation, as '%' may stand in a name; strict would refuse a section that occurs twice.
    sections = configparser.ConfigParser(interpolation=None, strict=False)
    try:
        sections.read_string(file.read_text(encoding="latin-1"))
    except (OSError, configparser.Error) as error:
        problem = str(error).replace("\n", " ")
        raise SheetError(f"{file}: cannot be read as a data sheet: {problem}") from error
    return sections


def _node(sections: configparser.ConfigParser) -> int:
    for section in ("DeviceComissioning", "DeviceCommissioning"):
        text = sections.get(section, "NodeID", fallback="").strip()
        if text:
            try:
                return int(text, 0)
            except ValueError:
                return 0
    return 0


def _objects(sections: configparser.ConfigParser) -> Iterator[tuple[Address, str]]:
    for section in sections.sections():
        fits = _OBJECT.fullmatch(section)
        if fits is not None:
            yield Address(int(fits[1], 16), int(fits[2] or "0", 16)), section


def _number(text: str, node: int) -> int:
    # CiA 306: $NODEID+0x600 adds the node's number.
    rest, relative = _NODE.subn("", text)
    return int(rest or "0", 0) + (node if relative else 0)
