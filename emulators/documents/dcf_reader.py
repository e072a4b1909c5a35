"""Reads the parameters in a device configuration file (CiA 306): each `ParameterValue` that is saved."""

import configparser
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from emulators.epos2.objects.saved_parameters import is_parameter
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.differences import ANY_TYPE

_OBJECT: Final = re.compile(r"(?i)([0-9a-f]{4})(?:sub([0-9a-f]{1,2}))?")
_NODE: Final = re.compile(r"(?i)\$nodeid\s*\+?\s*")
_MOST: Final = 8


class DcfError(Exception):
    """A file that is no configuration of an EPOS2: every section and key, and what is wrong with it."""


def parameters(file: Path) -> Mapping[Address, int]:
    """Return the values of the parameters in a file; commands, set values and strings are left out.

    DcfError where it cannot be read, has no value of an EPOS2's parameter, or values that are none.
    """
    sections = _sections(file)
    node = _node(sections)
    found: dict[Address, int] = {}
    problems: list[str] = []
    for address, section in _objects(sections):
        text = sections[section].get("parametervalue", "").strip()
        row = ANY_TYPE.get(address)
        if not text or row is None or not row.type.size or not is_parameter(row):
            continue
        try:
            value = _number(text, node)
        except ValueError:
            problems.append(f"[{section}] ParameterValue={text} is no number")
            continue
        if row.type.lowest < 0 and value > row.type.highest:
            value -= 1 << row.type.bits
        if not row.type.lowest <= value <= row.type.highest:
            problems.append(f"[{section}] ParameterValue={text} does not fit {row.type.name}")
        found[address] = value
    if problems:
        more = f"; and {len(problems) - _MOST} more" if len(problems) > _MOST else ""
        raise DcfError(f"{file}: {'; '.join(problems[:_MOST])}{more}")
    if not found:
        raise DcfError(f"{file}: no ParameterValue of an EPOS2's parameter is in it; is it an EDS?")
    return found


def _sections(file: Path) -> configparser.ConfigParser:
    sections = configparser.ConfigParser(interpolation=None, strict=False)
    try:
        sections.read_string(file.read_text(encoding="latin-1"))
    except (OSError, configparser.Error) as error:
        said = str(error).replace("\n", " ")
        raise DcfError(f"{file}: cannot be read as a configuration file: {said}") from error
    return sections


def _node(sections: configparser.ConfigParser) -> int:
    """Return the node that `$NODEID` stands for; 0 where the file does not say."""
    for section in ("DeviceComissioning", "DeviceCommissioning"):
        text = sections.get(section, "NodeID", fallback="")
        if text.strip():
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
    rest, relative = _NODE.subn("", text)
    return int(rest or "0", 0) + (node if relative else 0)
