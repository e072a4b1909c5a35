"""Look-up of objects: by name, in any spelling, or by index and sub-index.

It never guesses: a name that fits no object, or several, is answered with those that come near.
"""

import re
from collections.abc import Mapping
from difflib import get_close_matches
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.epos2.commissioning.client import CommissioningError
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE

MOST_SUGGESTED: Final = 5
_NUMBERED: Final = re.compile(
    r"0x(?P<index>[0-9a-f]{1,4})(?:[:./](?P<sub>0x[0-9a-f]{1,2}|[0-9]{1,3}|[0-9a-f]{2}))?", re.IGNORECASE
)


class UnknownObjectError(CommissioningError):
    """No object, or more than one, has this name."""


def squashed(name: str) -> str:
    """Return a name's letters and digits alone, so that spaces, dashes and capitals do not count."""
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _by_name() -> Mapping[str, tuple[ObjectRow, ...]]:
    found: dict[str, tuple[ObjectRow, ...]] = {}
    for row in ANY_TYPE.values():
        key = squashed(row.name)
        found[key] = (*found.get(key, ()), row)
    return MappingProxyType(found)


BY_NAME: Final = _by_name()


def dashed(name: str) -> str:
    """Return a name as a shell takes it without quotes: profile-velocity."""
    return "-".join(re.findall(r"[a-z0-9]+", name.lower()))


def find(text: str) -> Address:
    """Return the object that is meant by a name, `0x6081`, `0x60F6:1` or `0x202E:0A`; UnknownObjectError.

    Sub-indexes of digits alone are decimal. An index need not be in the table: a drive may know more.
    """
    numbered = _NUMBERED.fullmatch(text.strip())
    if numbered is not None:
        return Address(int(numbered["index"], 16), _subindex(text, numbered["sub"] or "0"))
    fitting = BY_NAME.get(squashed(text), ())
    if len(fitting) == 1:
        return fitting[0].address
    if fitting:
        raise UnknownObjectError(f"'{text}' is the name of {_listed(fitting)}; use the index")
    near = _near(squashed(text))
    if near:
        raise UnknownObjectError(f"no object is called '{text}'; did you mean {_listed(near)}?")
    raise UnknownObjectError(
        f"no object is called '{text}'; give a name of `firmware-bridge epos2 objects`, or an index, 0x6081 "
        "or 0x60F6:1"
    )


def name_of(address: Address) -> str:
    """Return an object's name; empty where it is not in the table."""
    row = ANY_TYPE.get(address)
    return "" if row is None else row.name


def _subindex(text: str, sub: str) -> int:
    number = int(sub, 10 if sub.isdigit() else 16)
    if number > 0xFF:  # noqa: PLR2004 - a byte
        raise UnknownObjectError(f"'{text}': a sub-index is 0 to 255")
    return number


def _near(wanted: str) -> tuple[ObjectRow, ...]:
    """Return the objects whose names hold what is wanted, the shortest first, or else look like it."""
    holding = sorted(
        (name for name in BY_NAME if wanted and wanted in name), key=lambda name: (len(name), name)
    )
    alike = get_close_matches(wanted, BY_NAME, n=MOST_SUGGESTED, cutoff=0.75)
    names = dict.fromkeys((*holding, *alike))
    return tuple(row for name in names for row in BY_NAME[name])[:MOST_SUGGESTED]


def _listed(rows: tuple[ObjectRow, ...]) -> str:
    texts = [f"{dashed(row.name)} ({row.address})" for row in rows]
    return " or ".join((", ".join(texts[:-1]), texts[-1])) if texts[1:] else texts[0]
