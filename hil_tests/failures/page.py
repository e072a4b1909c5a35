"""What stops RARS and how far it goes on, as tables for a page."""

from collections.abc import Iterable, Iterator
from typing import Final, TypeAlias

from hil_tests.failures.cases import (
    ASKED,
    FAILS,
    LINKS,
    MOTIONS,
    PHASES_MS,
    STORIES,
    Cause,
)
from hil_tests.failures.measured import KEPT, Worst
from validation.pages.pages import table

Cells: TypeAlias = tuple[str, ...]
ASKED_TEXT: Final = """Each stop that somebody asks for, at the worst of {draws} ways to begin it: {motions},
at three instants of a cycle, on the flat, by the plant's truth. **Base** is the way of the reference point
along its path, **lift** the platform's, each until it stands. A test drives the worst again, to the
millimetre."""
FAILS_TEXT: Final = """The same of what fails, at one axis that moves or for all. **Noticed** is the time
until the operator is told. What the drives themselves notice, nobody is left to tell."""
STORIES_TEXT: Final = "What no way can tell:"
REMAINS_TEXT: Final = """No program holds what has no power and no brake. With the user remain:

* a **switch that takes the power** of all drives, within reach of somebody who sees the robot: the bridge's
  emergency stop needs a radio, a program and a drive that are sound;
* **brakes** or blocked wheels wherever it may roll: without torque RARS rolls out over the ways above, and on
  a slope on: with its bridge killed on 5 degrees it is at 1.9 m/s 4 s later;
* the **ground**: the tipping limit is worked out for a plane. Steps, holes and slopes count against it.
  Downhill the tyres slip, and the robot is faster than its wheels: 0.513 m/s on 5 degrees at 0.5 asked;
* **an encoder that counts wrong** where no other sensor contradicts it: RARS has none of its yaw;
* **where it stands** after a restart: a height that is said wrong is believed;
* **people**: no row sees them."""
ASKED_HEADINGS: Final = (
    *("stop", "category", "what happens", "CAN: base", "CAN: lift", "serial: base", "serial: lift"),
    "remains with the user",
)
FAILS_HEADINGS: Final = (
    *("failure", "what happens", "CAN: noticed", "CAN: base", "CAN: lift"),
    *("serial: noticed", "serial: base", "serial: lift", "remains with the user"),
)
STORIES_HEADINGS: Final = ("what happens to it", "noticed as", "what comes of it", "test")


def sections() -> tuple[str, ...]:
    """Return the parts of the page, in Markdown."""
    count = len(MOTIONS) * len(PHASES_MS)
    motions = ", ".join(motion.name for motion in MOTIONS)
    stories = ((row.name, row.noticed, row.answer, f"`{row.test}`") for row in STORIES)
    return (
        "### How far a stop goes on",
        ASKED_TEXT.format(draws=count, motions=motions),
        table(ASKED_HEADINGS, asked()),
        "### What fails, and what comes of it",
        FAILS_TEXT,
        table(FAILS_HEADINGS, fails()),
        STORIES_TEXT,
        table(STORIES_HEADINGS, stories),
        "### What remains with the user",
        REMAINS_TEXT,
    )


def asked() -> Iterator[Cells]:
    """Yield the stops that somebody asks for."""
    rows = KEPT.read()
    for cause in ASKED:
        ways = [way for link in LINKS for way in _ways(cause, link, rows)]
        yield (cause.name, str(cause.category), cause.answer, *ways, cause.remains)


def fails() -> Iterator[Cells]:
    """Yield what fails."""
    rows = KEPT.read()
    for cause in FAILS:
        cells = [cell for link in LINKS for cell in (_noticed(cause, link, rows), *_ways(cause, link, rows))]
        yield (cause.name, cause.answer, *cells, cause.remains)


def _of(cause: Cause, link: str, rows: Iterable[Worst]) -> Iterator[Worst]:
    return (row for row in rows if (row.cause, row.link) == (cause.name, link))


def _ways(cause: Cause, link: str, rows: Iterable[Worst]) -> Cells:
    found = {row.drawn[1].motion.lifts: row for row in _of(cause, link, rows)}
    return tuple(
        f"{found[lifts].way_mm} mm, {found[lifts].rest_ms / 1000:.2f} s" if lifts in found else "-"
        for lifts in (False, True)
    )


def _noticed(cause: Cause, link: str, rows: Iterable[Worst]) -> str:
    """Return the longest time."""
    times = [row.noticed_ms for row in _of(cause, link, rows)]
    if not times:
        return "-"
    if not cause.tells:
        return "by the drives"
    return f"{max(time for time in times if time is not None)} ms"
