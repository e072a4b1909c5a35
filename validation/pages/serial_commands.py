"""The commands of maxon's serial protocols, one by one: data, answer, on which lines, known how far.

Computed from the table that both ends of the line work with.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Final

from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.maxon.opcodes import ROWS, Opcode, Shape

HEADINGS: Final = ("opcode", "command", "data", "answer", "V1", "V2", "known", "source", "tests")
UNTESTED: Final = "none"
_CODES: Final = {"B": "byte", "H": "word", "I": "double word"}
_PART: Final = re.compile(r"(\d*)([BHIs])")

Tests = Mapping[int, Sequence[str]]
"""Names of the tests that go through a command, by its opcode."""


def layout(shape: Shape) -> str:
    """Return a message's fields in the order on the wire, with their sizes."""
    names = [each.name for each in fields(shape.message)]
    kinds = [
        f"{count} bytes" if code == "s" else _CODES[code]
        for count, code in _PART.findall(shape.layout.format)
    ]
    if shape.open_ended:
        kinds.append("bytes, padded to words")
    return ", ".join(f"`{name}` {kind}" for name, kind in zip(names, kinds, strict=True))


def cells(row: Opcode, tests: Tests) -> tuple[str, ...]:
    """Return the texts of one line, as `HEADINGS` names them."""
    known = row.request is not None
    return (
        f"0x{row.opcode:02X}",
        row.name,
        "not known" if row.request is None else layout(row.request),
        layout(row.answer) if known else "refused as unknown",
        *(
            "answered" if known and generation in row.answered else _unanswered(known)
            for generation in Generation
        ),
        row.provenance.value,
        row.source,
        ", ".join(tests.get(row.opcode, ())) or UNTESTED,
    )


def table(tests: Tests) -> list[tuple[str, ...]]:
    """Return every line, in the order of the opcodes."""
    return [cells(row, tests) for row in sorted(ROWS, key=lambda row: row.opcode)]


def _unanswered(known: bool) -> str:  # noqa: FBT001 - one cell
    return "taken, not answered" if known else "refused"
