"""Tables for a page: the causes of a stop, and the stopping distance of each."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, TypeAlias

from firmware_bridge.robot.settings.shield import ShieldLink
from hil_tests.failures.causes import (
    COMMON,
    EVERY,
    LINES,
    PHASES_MS,
    RARS,
    REQUESTED,
    STRAIGHT,
    WORST_OF,
    Cause,
)
from hil_tests.failures.drive import KEPT, WATCHED_S, Outcome
from hil_tests.failures.rars import FAILS, SHOWN
from hil_tests.safety.driving import ARM, SPEEDS, robot_of
from validation.pages.pages import table

Cells: TypeAlias = tuple[str, ...]
EVERY_TEXT: Final = """Straight ahead at {speed}, on the flat, by the plant's truth: how far it goes on, for
how long, and who stops it; with several steps of a stop, those that its axes needed. "Line cut" is the
bridge's end of a bus, the adapter of a serial line, or a board's cable, for good; "reset" a board's button,
or a drive's supply for 0.3 s. A test drives each row again, to the millimetre."""
BOARDS_TEXT: Final = """No wire leads from the board's reset to the shield: the motors run on as they were
commanded while a board boots, and to set it up releases them. The cycle's next question keeps the boot
loader of a Mega that was reset, for as long as someone speaks; a board that hangs looks the same. So both
are sent a release, are reset, and hear nothing until the firmware must run. The auto-stop of
ros_arduino_bridge hangs with its sketch, and counts only where the line is cut; there a board without one
**runs on** until the line is back: keep a hardware switch within reach."""
REQUESTED_TEXT: Final = """Each stop that someone asks for, at the worst of {draws} ways to begin it:
{motions}, at three instants of a cycle, on the flat, by the plant's truth. **Base** is how far the
reference point goes, **lift** the platform, each until it stands. A test drives the worst again, to the
millimetre."""
FAILS_TEXT: Final = """The same of what fails, at one axis that moves or for all. **Noticed** is the time
until the operator is informed. What the drives themselves notice, no one is left to report."""
SHOWN_TEXT: Final = "What no distance can say:"
REMAINS_TEXT: Final = """No program holds what has no power and no brake. With the user remain:

* a **switch that takes the power** of all drives, within reach of someone who sees the robot: the bridge's
  emergency stop needs a radio, a program and a drive that are sound;
* **brakes** or blocked wheels wherever it may roll: without torque RARS rolls out over the ways above, and on
  a slope on: with its bridge killed on 5 degrees it is at 1.9 m/s 4 s later;
* the **ground**: the tipping limit is worked out for a plane. Steps, holes and slopes count against it.
  Downhill the tyres slip, and the robot is faster than its wheels: 0.513 m/s on 5 degrees at 0.5 asked;
* **an encoder that counts wrong** where no other sensor contradicts it: RARS has none of its yaw;
* **where it stands** after a restart: a height that is said wrong is believed;
* **people**: no row sees them."""
REQUESTED_HEADINGS: Final = (
    *("stop", "category", "what happens", "CAN: base", "CAN: lift", "serial: base", "serial: lift"),
    "remains with the user",
)
FAILS_HEADINGS: Final = (
    *("failure", "what happens", "CAN: noticed", "CAN: base", "CAN: lift"),
    *("serial: noticed", "serial: base", "serial: lift", "remains with the user"),
)
SHOWN_HEADINGS: Final = ("what happens to it", "noticed as", "what comes of it", "test")


def sections(robot: str) -> tuple[str, ...]:
    """Return the parts of the page on one robot, in Markdown."""
    lines = LINES.get(robot, ())
    if not lines:
        return ()
    speed = f"{SPEEDS.get(robot, 0.3):g} m/s" if robot != ARM else "20 mm/s at the tool"
    boards = (BOARDS_TEXT,) if robot_of(lines[0]).shield_links else ()
    headings = ("what happens", *map(_title, lines))
    every = ("### What comes of it, measured", EVERY_TEXT.format(speed=speed), table(headings, _cells(lines)))
    return (*every, *boards, *(_worst() if lines == RARS else ()))


def _worst() -> tuple[str, ...]:
    count = len(WORST_OF) * len(PHASES_MS)
    motions = ", ".join(motion.name for motion in WORST_OF)
    shown = ((row.name, row.noticed, row.answer, f"`{row.test}`") for row in SHOWN)
    return (
        "### How far a stop goes on",
        REQUESTED_TEXT.format(draws=count, motions=motions),
        table(REQUESTED_HEADINGS, requested()),
        "### What fails, and what comes of it",
        FAILS_TEXT,
        table(FAILS_HEADINGS, fails()),
        SHOWN_TEXT,
        table(SHOWN_HEADINGS, shown),
        "### What remains with the user",
        REMAINS_TEXT,
    )


def _title(line: str) -> str:
    link = next(iter(robot_of(line).links.values()))
    spoken = f", {link.protocol.value}" if isinstance(link, ShieldLink) else ""
    return f"{link.driver.value}{spoken}"


def _cells(lines: Sequence[str]) -> Iterator[Cells]:
    rows = {(row.cause, row.line): row for row in KEPT.read() if row.motion == STRAIGHT.name}
    common = (*(cause for cause in REQUESTED if cause.lines == EVERY), *COMMON)
    for cause in common:
        found = [rows.get((cause.name, line)) for line in lines]
        if any(found):
            yield (cause.name, *("-" if row is None else _cell(row) for row in found))


def _cell(row: Outcome) -> str:
    if row.rest_ms < 0:
        return f"**drives on**: {row.way_mm / 1000:.1f} m in {WATCHED_S:g} s"
    return f"{row.way_mm} mm, {row.rest_ms / 1000:.2f} s, {row.by}"


def requested() -> Iterator[Cells]:
    """Yield the requested stops."""
    rows = KEPT.read()
    for cause in REQUESTED:
        ways = [way for line in RARS for way in _ways(cause, line, rows)]
        yield (cause.name, str(cause.category), cause.answer, *ways, cause.remains)


def fails() -> Iterator[Cells]:
    """Yield what fails."""
    rows = KEPT.read()
    for cause in FAILS:
        cells = [cell for line in RARS for cell in (_noticed(cause, line, rows), *_ways(cause, line, rows))]
        yield (cause.name, cause.answer, *cells, cause.remains)


def _of(cause: Cause, line: str, rows: Iterable[Outcome]) -> Iterator[Outcome]:
    wanted = cause.name, line
    return (row for row in rows if (row.cause, row.line) == wanted and row.motion != STRAIGHT.name)


def _ways(cause: Cause, line: str, rows: Iterable[Outcome]) -> Cells:
    found = {row.case.motion.lifts: row for row in _of(cause, line, rows)}
    return tuple(
        f"{found[lifts].way_mm} mm, {found[lifts].rest_ms / 1000:.2f} s" if lifts in found else "-"
        for lifts in (False, True)
    )


def _noticed(cause: Cause, line: str, rows: Iterable[Outcome]) -> str:
    """Return the longest time."""
    times = [row.noticed_ms for row in _of(cause, line, rows)]
    if not times:
        return "-"
    if not cause.reports:
        return "by the drives"
    return f"{max(time for time in times if time is not None)} ms"
