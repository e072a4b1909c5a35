"""The ledger: what of the emulated drive is proven, documented, by analogy, or assumed, and from where.

It is read from the tables that the emulation works with, and from the assumptions that its modules state.
"""

import re
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

import emulators
from emulators.epos2.control.value_ranges import VALUE_RANGES
from emulators.epos2.documents.object_table import entries
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.choices import CHOICES
from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.canopen.object_row import Provenance
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES

ORDER: Final = tuple(Provenance)
_FIGURES: Final = (
    "order_numbers",
    "hardware_version",
    "software_version",
    "continuous_current_ma",
    "peak_current_ma",
    "supply_v",
)
_ROOT: Final = Path(emulators.__file__).parent
_MODULES: Final = ("canopen", "drive", "epos2", "servo", "wires")
_ASSUMPTION: Final = re.compile(
    r"""(?:(?P<before>[^."()]{3,}[.:;]?)\s*\(?)?\b[Aa]ssumed: (?P<what>.+?)"""
    r"""(?:\.(?=\s|$|"|\))|\)(?=[.;:, ]|$)|\"{3})"""
)
_SILENT: Final = re.compile(r"Where (?:it is|they are|the sources are) silent: (?P<what>.+?)\"{3}")


@dataclass(frozen=True, slots=True)
class LedgerLine:
    """One thing that the emulation does, and how far it is known."""

    part: str
    what: str
    provenance: Provenance
    source: str


@cache
def ledger() -> tuple[LedgerLine, ...]:
    """Return every line, part by part; the sources are read once."""
    return (*_objects(), *_defaults(), *_rules(), *_choices(), *_types(), *_emergencies(), *_stated())


def counted() -> dict[str, Counter[Provenance]]:
    """Return how many lines of each part are known how far."""
    found: dict[str, Counter[Provenance]] = {}
    for line in ledger():
        found.setdefault(line.part, Counter())[line.provenance] += 1
    return found


def _objects() -> Iterator[LedgerLine]:
    for row in EPOS2_70_10.objects.values():
        yield LedgerLine("objects", f"{row.address} {row.name}", row.provenance, row.source)


def _defaults() -> Iterator[LedgerLine]:
    for entry in entries(EPOS2_70_10):
        row = entry.row
        what = f"{row.address} {row.name}: {entry.default_text or 'empty'}"
        yield LedgerLine("defaults of the 70/10", what, row.default_provenance, row.default_source)


def _rules() -> Iterator[LedgerLine]:
    for rule in VALUE_RANGES:
        what = f"{rule.address} {EPOS2_70_10.objects[rule.address].name} takes only {_span(rule.allowed)}"
        yield LedgerLine("refused values", what, rule.provenance, rule.source)


def _span(values: Collection[int]) -> str:
    if isinstance(values, range):  # which may be too long to be counted out
        return f"{values[0]} to {values[-1]}"
    ordered = sorted(values)
    if len(ordered) > 2 and ordered == list(range(ordered[0], ordered[-1] + 1)):  # noqa: PLR2004 - a range
        return f"{ordered[0]} to {ordered[-1]}"
    return ", ".join(map(str, ordered))


def _choices() -> Iterator[LedgerLine]:
    for choice in CHOICES.values():
        what = f"{choice.name}={choice.text}"
        yield LedgerLine("choices (`--choice`)", what, choice.known.provenance, choice.known.source)


def _types() -> Iterator[LedgerLine]:
    for profile in PROFILES.values():
        for name in _FIGURES:
            mark = profile.known(name)
            value = getattr(profile, name)
            if name in {"hardware_version", "software_version"} and value:
                value = f"{value:#06x}"
            elif isinstance(value, tuple):
                value = ", ".join(value)
            what = f"{profile.name}: {name} = {value or 'not known'}"
            yield LedgerLine("figures of the types", what, mark.provenance, mark.source)


def _emergencies() -> Iterator[LedgerLine]:
    for row in EMERGENCIES.values():
        yield LedgerLine("emergencies", f"0x{row.code:04X} {row.cause}", row.provenance, row.source)


def _stated() -> Iterator[LedgerLine]:
    """Give the assumptions that the modules of the drive state where they make them."""
    for folder in _MODULES:
        for path in sorted((_ROOT / folder).rglob("*.py")):
            where = path.relative_to(_ROOT.parent).as_posix()
            for what in stated(path.read_text(encoding="utf-8")):
                yield LedgerLine("stated assumptions", what, Provenance.ASSUMED, where)


def stated(text: str) -> list[str]:
    """Return the assumptions that a module's comments and docstrings state, with what they are about."""
    # One line of text: an assumption may run over several comment lines.
    flat = " ".join(line.strip().removeprefix("#").strip() for line in text.splitlines())
    wording = [_joined(it["before"] or "", it["what"]) for it in _ASSUMPTION.finditer(_SILENT.sub("", flat))]
    silent = [
        part
        for it in _SILENT.finditer(flat)
        for part in (it["what"].split(" * ") if it["what"].startswith("* ") else it["what"].split("; "))
    ]
    return [line for line in (" ".join(each.split()).strip("* .") for each in (*wording, *silent)) if line]


def _joined(before: str, what: str) -> str:
    """Put what an assumption is about in front of it, where the text before is a sentence."""
    before = before.strip()
    if not before or not before[0].isupper():
        return what
    return f"{before.rstrip('.:')}: {what}"
