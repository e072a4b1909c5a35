"""The page, the pictures and the table of a recorded drive, as the bench makes them of its runs.

Measurements take the place of a plant's values; the robot's true motion is unknown.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

import numpy as np

from emulators.bench.animated import animated
from emulators.bench.bench_setup import BenchSetup
from emulators.bench.columns import Floats, current
from emulators.bench.page import active, beginning, shown
from emulators.bench.summary import entry_of
from emulators.bench.web import document
from emulators.replay.measured import Measured
from firmware_bridge.extras import installed
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import to_seconds

PAGE, TABLE, ANIMATED = "report.html", "samples.csv", "animated.html"
EVENTS: Final = "events.log"
LINES: Final = 200
"""Number of logged lines on the page; the file has them all."""


def written(
    folder: Path,
    title: str,
    robot: AnyRobot,
    bench_setup: BenchSetup,
    run: Measured,
    *,
    again: str,
    animate: bool,
) -> list[Path]:
    """Write page, table, pictures, and what plays the path, into the folder; return their paths. OSError."""
    (folder / TABLE).write_text(run.samples.csv(), encoding="ascii")
    pictures: list[Path] = []
    if installed("plots"):
        # Half a second for Matplotlib, which no one needs before.
        from emulators.bench.plots import draw  # noqa: PLC0415 - see above

        pictures = draw(folder, title, robot, bench_setup.panels, run.samples, events=run.interlock_events)
    rows = list(numbers(robot, run, bench_setup.remarks(robot)))
    parts = (
        *beginning(title, again, rows),
        *_differs(run),
        *active([entry_of(event) for event in run.interlock_events]),
        *_texts(folder),
        *shown(pictures),
    )
    (folder / PAGE).write_text(document(title, "".join(parts)), encoding="utf-8")
    made = [folder / PAGE, folder / TABLE, *pictures]
    if animate:
        text = animated(title, run.samples, [entry_of(event) for event in run.interlock_events])
        (folder / ANIMATED).write_text(text, encoding="utf-8")
        made.append(folder / ANIMATED)
    return made


def numbers(robot: AnyRobot, run: Measured, remarks: Mapping[str, str]) -> Iterator[Sequence[str]]:
    """Yield what was measured, its value, unit and remark."""
    samples = run.samples
    yield "recorded time", f"{to_seconds(run.lasts):.1f}", "s", f"{run.packets} packets on all links"
    armed = float(np.count_nonzero(samples.column("armed"))) / max(len(samples), 1)
    yield "armed", f"{100.0 * armed:.0f}", "%", "of the time"
    if samples.has("speed_mps"):
        limit = remarks.get("max_speed_mps", "")
        yield "largest speed", f"{_largest(samples.column('speed_mps')):.3f}", "m/s", limit
    if samples.has("odometry_x_m"):
        x, y = (samples.column(f"odometry_{axis}_m") for axis in "xy")
        steps = np.hypot(np.diff(x), np.diff(y))
        yield "path length", f"{float(np.nansum(steps)):.3f}", "m", "by odometry"
    for axis in robot.axes:
        if samples.has(current(axis.name)):
            most = _largest(samples.column(current(axis.name)))
            yield f"largest current, {axis.title}", f"{most:.2f}", "A", "measured by its device"


def _differs(run: Measured) -> Iterator[str]:
    if run.differs_at is not None:
        yield (
            f'<p class="wrong">From {to_seconds(run.differs_at):.3f} s on this version of the bridge does '
            "otherwise than was recorded: its set-points and active interlocks may differ from that day.</p>"
            f"<pre>{escape(run.difference)}</pre>"
        )


def _texts(folder: Path) -> Iterator[str]:
    try:
        lines = (folder / EVENTS).read_text("utf-8", errors="replace").splitlines()
    except OSError:
        return
    left_out = f"\n... {len(lines) - LINES} more in {EVENTS}" if len(lines) > LINES else ""
    yield f"<h2>Messages</h2><pre>{escape(chr(10).join(lines[:LINES]) + left_out)}</pre>"


def _largest(values: Floats) -> float:
    finite = values[np.isfinite(values)]
    return float(np.abs(finite).max()) if finite.size else math.nan
