"""A run as one page of HTML that needs no other file: measurements, active interlocks, what was wrong."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from emulators.bench.report import numbers, span
from emulators.bench.summary import Faulted, InterlockEntry, Summary
from emulators.bench.web import document, picture, table

MEASURED: Final = ("measured", "value", "unit", "remark")
ACTIVE: Final = ("from", "to", "interlock", "reason", "what to do")
FAULTS: Final = ("from", "to", "fault", "where", "title")
SPAN: Final = (0, 1)
"""The places of both times, which stand to the right."""


def page(summary: Summary, remarks: Mapping[str, str], pictures: Sequence[Path], again: str) -> str:
    """Return the page of a run on the bench.

    `remarks` stand beside numbers, `again` is the line that runs it again. OSError where a picture cannot be
    read.
    """
    title = f"{summary.robot}, {summary.mission}, seed {summary.seed}"
    parts = (
        *beginning(title, again, numbers(summary, remarks)),
        *active(summary.interlock_events),
        "<h2>Faults that were put on</h2>",
        table(FAULTS, map(_faulted, summary.faults), SPAN) if summary.faults else "<p>none</p>",
        *shown(pictures),
    )
    return document(title, "".join(parts))


def beginning(title: str, again: str, rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Yield the heading, the line that makes it again, and what was measured."""
    yield f"<h1>{escape(title)}</h1><p>again: <code>{escape(again)}</code></p>"
    yield table(MEASURED, rows, (1,))


def active(events: Sequence[InterlockEntry]) -> Iterator[str]:
    """Yield the active interlocks."""
    yield "<h2>Active interlocks</h2>"
    yield table(ACTIVE, map(_active, events), SPAN) if events else "<p>none</p>"


def shown(pictures: Iterable[Path]) -> Iterator[str]:
    """Yield pictures within the page; OSError where one cannot be read."""
    for path in pictures:
        yield f"<figure>{picture(path.read_bytes(), 'png', path.stem)}</figure>"


def _active(event: InterlockEntry) -> tuple[str, ...]:
    return (*span(event), event.name, event.reason, event.remedy)


def _faulted(fault: Faulted) -> tuple[str, ...]:
    return (*span(fault), fault.kind, ", ".join(fault.nodes), fault.title)
