"""Choices that the sources leave open, for the user to make: `--choice mapping-needs-invalid-pdo=yes`.

Each is a field of the device profile with its provenance; the ledger lists them with default and evidence.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any, Final, get_args, get_type_hints

from emulators.epos2.objects.device_profile import DeviceProfile, Known
from firmware_bridge import renamed
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND

ELSEWHERE: Final = frozenset({"bit_rate", "rs232_rate"})
"""Fields that have an option of their own."""
TIMES: Final = frozenset(
    {"boot_time", "sdo_latency", "serial_latency", "gateway_latency", "gateway_timeout", "poll"}
)
"""Fields in ns, which are read and written with a unit."""
WORD: Final = (0, 0xFFFF)
LONGEST: Final = (0, 60 * SECOND)
RANGES: Final[Mapping[str, tuple[int, int]]] = MappingProxyType(
    {
        "serial_number": (0, (1 << 64) - 1),
        "interpolation_buffer": (2, 64),
        "gateway_segment": (1, 63),
        "gateway_timeout": (MILLISECOND, 60 * SECOND),
        "poll": (100 * MICROSECOND, SECOND),
    }
)
"""Range of a number that is neither a word nor a time up to the longest reasonable one."""
UNITS: Final[Mapping[str, int]] = MappingProxyType({"s": SECOND, "ms": MILLISECOND, "us": MICROSECOND})


class ChoiceError(ValueError):
    """No such choice, or no such value of it: one line that lists the valid ones."""


@dataclass(frozen=True, slots=True)
class Choice:
    """One open question, and how it is answered by default."""

    field: str
    kind: type
    default: Any
    known: Known

    @property
    def name(self) -> str:
        """The name that the command line takes."""
        return self.field.replace("_", "-")

    @property
    def text(self) -> str:
        """The default as the command line takes it."""
        return _text(self, self.default)

    def read(self, text: str) -> Any:
        """Return the value of a text; ValueError or KeyError where it has none."""
        if self.kind is not int:
            return READERS[self.kind](text)
        value = _nanoseconds(text) if self.field in TIMES else int(text, 0)
        low, high = RANGES.get(self.field, LONGEST if self.field in TIMES else WORD)
        if not low <= value <= high:
            raise ValueError(text)
        return value


def _truth(text: str) -> bool:
    return {"yes": True, "no": False}[text]


def _abort_code(text: str) -> AbortCode:
    return {int(code): code for code in AbortCode}[int(text, 16)]


def _four_bytes(text: str) -> bytes:
    value = bytes.fromhex(text)
    if len(value) != 4:  # noqa: PLR2004 - as in the profile
        raise ValueError(text)
    return value


def _nanoseconds(text: str) -> int:
    fits = re.fullmatch(r"(\d+(?:\.\d+)?)(s|ms|us)", text)
    if fits is None:
        raise ValueError(text)
    return round(float(fits[1]) * UNITS[fits[2]])


READERS: Final[Mapping[type, Callable[[str], Any]]] = MappingProxyType(
    {bool: _truth, AbortCode: _abort_code, bytes: _four_bytes}
)
FORMS: Final[Mapping[type, str]] = MappingProxyType(
    {
        bool: "yes or no",
        int: "a whole number",
        AbortCode: "an abort code, as 0x06010000",
        bytes: "four bytes, as 00000000",
    }
)


def _text(choice: Choice, value: Any) -> str:
    if choice.field in TIMES:
        unit = next(unit for unit, size in UNITS.items() if value % size == 0 and (value or unit == "ms"))
        return f"{value // UNITS[unit]}{unit}"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, AbortCode):
        return f"{int(value):#010x}"
    return value.hex() if isinstance(value, bytes) else str(value)


def _choices() -> Mapping[str, Choice]:
    hints = get_type_hints(DeviceProfile, include_extras=True)
    found = {}
    for each in fields(DeviceProfile):
        marks = [mark for mark in getattr(hints[each.name], "__metadata__", ()) if isinstance(mark, Known)]
        if marks and each.name not in ELSEWHERE:
            choice = Choice(each.name, get_args(hints[each.name])[0], each.default, marks[0])
            found[choice.name] = choice
    return MappingProxyType(found)


CHOICES: Final[Mapping[str, Choice]] = _choices()
"""Every choice by the name that the command line takes."""


def chosen(profile: DeviceProfile, texts: Iterable[str]) -> DeviceProfile:
    """Return the profile with choices of the form NAME=VALUE; ChoiceError."""
    changes = {}
    for text in texts:
        name, _, value = text.partition("=")
        name = renamed.current(name, renamed.CHOICES, "--choice")
        choice = CHOICES.get(name)
        if choice is None:
            near = get_close_matches(name, CHOICES, 1)
            hint = f"; did you mean {near[0]}?" if near else f"; there are: {', '.join(CHOICES)}"
            raise ChoiceError(f"--choice {text}: there is no choice '{name}'{hint}")
        try:
            changes[choice.field] = choice.read(value)
        except (ValueError, KeyError):
            form = "a time, as 300ms" if choice.field in TIMES else FORMS[choice.kind]
            raise ChoiceError(f"--choice {text}: give {form}; it is {choice.text} by default") from None
    return replace(profile, **changes)
