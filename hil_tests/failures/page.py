"""Tables for a page: the causes of a stop, and the stopping distance of each."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, TypeAlias

from firmware_bridge.families.motor_shield.settings import ShieldLink
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
EVERY_TEXT: Final = """Each robot was driven straight ahead on the flat; its page has
stopping distance, stopping time, measured in the plant, and what stops it; of several stop stages, those that
its axes needed. "Line cut" is the bridge's end of a bus, the adapter of a serial line, or a board's cable,
permanently; "reset" is a board's button, or an interruption of a drive's supply for 0.3 s. A test repeats
each row, to the millimeter."""
BOARDS_TEXT: Final = """No wire leads from the board's reset to the shield: the motors keep running as
commanded while a board boots, and its set-up releases them. After a reset, the next request of the cycle
keeps a Mega in its boot loader for as long as bytes arrive; a board that hangs cannot be distinguished from
it. So both are sent a release, are reset, and are sent nothing until the firmware must run. The auto-stop of
ros_arduino_bridge hangs with its sketch, and helps only if the line is cut; a board without an auto-stop then
**keeps driving** until the line is back: keep a hardware switch within reach."""
REQUESTED_TEXT: Final = """Each requested stop, the worst of {draws} initial conditions:
{motions}, at three instants of a cycle, on the flat, measured in the plant. **Base** is the distance of the
reference point, **lift** that of the platform, each until standstill. A test repeats the worst case, to the
millimeter."""
FAILS_TEXT: Final = """The same for failures, of one moving axis or of all. **Noticed** is the time until the
operator is informed; "by the drives": only the drives detect it, without a report."""
SHOWN_TEXT: Final = "Effects without a stopping distance:"
REMAINS_TEXT: Final = """No program holds an axis without power and without a brake. The user has to provide
for:

* a **switch that disconnects the power** of all drives, within reach of a person who sees the robot: the
  bridge's emergency stop needs a working radio, program and drive;
* **brakes** or blocked wheels wherever the robot may roll: without torque RARS coasts over the distances
  above, and on a slope it keeps rolling: with its bridge killed on 5 degrees it reaches 1.9 m/s 4 s later;
* the **ground**: the tipping limit is computed for a plane. Steps, holes and slopes reduce the margin.
  Downhill the tires slip, and the robot is faster than its wheels: 0.513 m/s on 5 degrees, commanded 0.5;
* **an encoder that counts wrong** without another sensor that contradicts it: RARS has none for its yaw;
* the **position** after a restart: a wrong height that is confirmed is accepted;
* **people**: no interlock detects them."""
REQUESTED_HEADINGS: Final = (
    *("stop", "category", "reaction", "CAN: base", "CAN: lift", "serial: base", "serial: lift"),
    "measure by the user",
)
FAILS_HEADINGS: Final = (
    *("failure", "reaction", "CAN: noticed", "CAN: base", "CAN: lift"),
    *("serial: noticed", "serial: base", "serial: lift", "measure by the user"),
)
SHOWN_HEADINGS: Final = ("event", "noticed as", "effect", "test")


def sections(robot: str) -> tuple[str, ...]:
    """Return the parts of the page on one robot, in Markdown."""
    lines = LINES.get(robot, ())
    if not lines:
        return ()
    speed = f"{SPEEDS.get(robot, 0.3):g} m/s" if robot != ARM else "20 mm/s at the tool"
    headings = ("cause", *map(_title, lines))
    every = ("### Measured stops", f"Straight ahead at {speed}, on the flat:", table(headings, _cells(lines)))
    return (*every, *(_worst() if lines == RARS else ()))


def general() -> tuple[str, ...]:
    """Return what the tables of all robots have in common."""
    return ("### Measured stops", EVERY_TEXT, BOARDS_TEXT)


def _worst() -> tuple[str, ...]:
    count = len(WORST_OF) * len(PHASES_MS)
    motions = ", ".join(motion.name for motion in WORST_OF)
    shown = ((row.name, row.noticed, row.answer, f"`{row.test}`") for row in SHOWN)
    return (
        "### Stopping distances",
        REQUESTED_TEXT.format(draws=count, motions=motions),
        table(REQUESTED_HEADINGS, requested()),
        "### Failures and their effects",
        FAILS_TEXT,
        table(FAILS_HEADINGS, fails()),
        SHOWN_TEXT,
        table(SHOWN_HEADINGS, shown),
        "### Measures by the user",
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
        return f"**keeps driving**: {row.way_mm / 1000:.1f} m in {WATCHED_S:g} s"
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
