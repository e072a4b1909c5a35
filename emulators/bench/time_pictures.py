"""A run over time: the robot's own panels, currents, and active interlocks."""

import math
from collections.abc import Mapping, Sequence
from itertools import cycle
from textwrap import shorten
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from emulators.bench.columns import Panel, Samples, current
from emulators.bench.envelope import band_label, draw_curve
from emulators.bench.halo import HALO
from emulators.bench.records import FaultRecord, InterlockEvent
from emulators.bench.style import BLUE, GREEN, INK, ORANGE, PALE, PURPLE, SKY, VERMILION
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import to_seconds

CURVE_COLORS: Final = (BLUE, GREEN, PURPLE, SKY, INK)
"""Colors of curves, in each panel from the first one; not those of set-points, limits and faults."""
SET_POINT: Final[Mapping[str, Any]] = {
    "color": ORANGE,
    "linewidth": 3.4,
    "alpha": 0.6,
    "drawstyle": "steps-post",
}
LEGEND: Final[Mapping[str, Any]] = {
    "loc": "lower right",
    "bbox_to_anchor": (1.0, 0.99),
    "borderaxespad": 0.0,
    "fontsize": 8.0,
    "columnspacing": 1.2,
    "handlelength": 1.5,
}
ROOM: Final = 145
"""Letters that title and legend of a panel have room for in one line; a legend's handle counts as eight."""
LEAST_CURRENT_A: Final = 0.1
"""A picture's current axis reaches at least this far, or noise would look like a load."""
REASON_LETTERS: Final = 70


def panels_picture(
    figure: Figure,
    robot: AnyRobot,
    panels: Sequence[Panel],
    samples: Samples,
    events: Sequence[InterlockEvent],
) -> None:
    """Draw the robot's own panels below each other, those of which there is a curve."""
    panels = [panel for panel in panels if any(samples.has(curve.column) for curve in panel.curves)]
    figure.set_size_inches(10.0, 2.2 + 0.9 * sum(panel.height for panel in panels))
    rows = figure.subplots(
        len(panels), 1, sharex=True, squeeze=False, height_ratios=[panel.height for panel in panels]
    )[:, 0]
    for axes, panel in zip(rows, panels, strict=True):
        if panel.shaded:
            _shade(axes, events, samples)
        if panel.limit is not None:
            _limit(axes, *panel.limit(robot), panel, samples)
        axes.set(title=panel.title, ylabel=panel.label)
        _curves(axes, panel, samples)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    _finish_time(rows[-1], samples)


def currents_picture(figure: Figure, robot: AnyRobot, samples: Samples) -> None:
    """Draw each motor's current in a row of its own, where it is known."""
    known = [axis for axis in robot.axes if samples.has(current(axis.name))]
    figure.set_size_inches(10.0, 1.2 + 1.7 * len(known))
    rows = figure.subplots(len(known), 1, sharex=True, squeeze=False)[:, 0]
    for axis, axes, color in zip(known, rows, cycle(CURVE_COLORS), strict=False):
        drawn = samples.column(current(axis.name))
        found = draw_curve(axes, samples.seconds, drawn, color)
        rms = math.sqrt(float(np.nanmean(drawn**2)))
        most = float(np.nanmax(np.abs(drawn)))
        axes.set(title=f"{axis.title.capitalize()}, {axis.settings.address}", ylabel="motor current [A]")
        continuous = axis.settings.continuous_current_ma / 1000.0
        # Far from the continuous current, its lines would only make the curve flat.
        near = most > 0.7 * continuous
        notes = [f"line: mean, {band_label(found)}"] if found else []
        notes.append(f"RMS {rms:.2f} A, peak {most:.2f} A")
        notes.append(f"continuous limit {continuous:g} A{' (dotted)' if near else ''}")
        axes.text(
            1.0,
            1.02,
            "; ".join(notes),
            transform=axes.transAxes,
            ha="right",
            va="bottom",
            color=PALE,
            fontsize=8.5,
        )
        for edge in (continuous, -continuous) if near else ():
            axes.axhline(edge, color=VERMILION, linewidth=1.0, linestyle=":")
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, -LEAST_CURRENT_A), max(high, LEAST_CURRENT_A))
        axes.yaxis.set_major_locator(MaxNLocator(5))
    _finish_time(rows[-1], samples)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()


def interlocks_picture(
    figure: Figure,
    samples: Samples,
    events: Sequence[InterlockEvent],
    faults: Sequence[FaultRecord] = (),
) -> None:
    """Draw a row for each interlock, with its first reason, one for the armed state, one for each fault."""
    names = list(dict.fromkeys(event.name for event in events))
    kinds = list(dict.fromkeys(fault.kind for fault in faults))
    figure.set_size_inches(10.0, 1.6 + 0.55 * len(names) + 0.4 * len(kinds))
    axes = figure.add_subplot()
    end = to_seconds(samples[-1].at)
    shortest = end / 400.0  # so that an event of one cycle is seen at all
    for row, name in enumerate(names):
        rows = [event for event in events if event.name == name]
        bars = [(to_seconds(event.began), max(_seconds_active(event, end), shortest)) for event in rows]
        axes.broken_barh(bars, (row - 0.2, 0.62), facecolor=BLUE)
        late = bars[0][0] > 0.5 * end
        axes.annotate(
            shorten(rows[0].reason, REASON_LETTERS, placeholder=" ..."),
            (bars[0][0], row - 0.26),
            ha="right" if late else "left",
            va="bottom",
            fontsize=8.0,
            color=INK,
            path_effects=HALO,
        )
    armed = [(to_seconds(row.at), 0.01) for row in samples if row["armed"]]
    axes.broken_barh(armed, (len(names) - 0.18, 0.36), facecolor=PALE)
    for row, kind in enumerate(kinds, len(names) + 1):
        marks = [(to_seconds(it.began), _seconds_active(it, end)) for it in faults if it.kind == kind]
        bars = [(began, max(length, shortest)) for began, length in marks]
        axes.broken_barh(bars, (row - 0.18, 0.36), facecolor=VERMILION)
    faulty = [f"fault: {kind.replace('_', ' ')}" for kind in kinds]
    labels = [*(name.replace("_", " ") for name in names), "state: armed", *faulty]
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.set(title="Active interlocks, each with the reason of its first event", xlabel="time [s]")
    _finish_time(axes, samples)


def _curves(axes: Axes, panel: Panel, samples: Samples) -> None:
    """Draw a panel's curves, the second quantity's on an axis at the right, and its legend."""
    curves = [curve for curve in panel.curves if samples.has(curve.column)]
    sides = {True: axes.twinx()} if any(curve.right for curve in curves) else {}
    colors = cycle(CURVE_COLORS)
    bands: list[str] = []
    for curve in curves:
        side = sides.get(curve.right, axes)
        label = curve.label if samples.truth else curve.label.replace("plant", "measured")
        if sides:
            label += " (right axis)" if curve.right else " (left axis)"
        drawn = samples.column(curve.column) * curve.scale
        if curve.step:
            side.plot(samples.seconds, drawn, label=label, **SET_POINT)
        elif found := draw_curve(side, samples.seconds, drawn, next(colors), label):
            bands.append(band_label(found))
    if panel.least:
        low, high = axes.get_ylim()
        axes.set_ylim(bottom=min(-panel.least / 4.0, low), top=max(panel.least, high))
    for right in sides.values():
        right.set_ylabel(panel.right)
        right.spines[right.yaxis.get_ticks_position()].set_visible(True)
        right.grid(visible=False)
        _align_zeros((axes, right))
    _legend((axes, *sides.values()), panel, bands)


def _legend(sides: Sequence[Axes], panel: Panel, bands: Sequence[str]) -> None:
    """Name the lines of all axes of a panel, where there is more than one, and its envelopes."""
    handles = [handle for side in sides for handle in side.get_legend_handles_labels()[0]]
    handles += [Patch(facecolor=PALE, alpha=0.4, label=label) for label in bands[:1]]
    # One curve alone is named by the panel's title.
    if not handles[1:]:
        return
    sides[0].legend(handles=handles, ncols=len(handles), **LEGEND)
    letters = sum(len(str(handle.get_label())) + 8 for handle in handles)
    # The title is set in larger letters than the legend, and above it where both would meet.
    if letters + 1.8 * len(panel.title) > ROOM:
        sides[0].set_title(panel.title, pad=21.0)


def _align_zeros(sides: Sequence[Axes]) -> None:
    """Put the zeros of both axes at one height: a curve's sign is read against one line."""
    limits = [(min(low, 0.0), max(high, 0.0)) for low, high in (side.get_ylim() for side in sides)]
    share = min(max(*(-low / (high - low) for low, high in limits), 0.05), 0.95)
    for side, (low, high) in zip(sides, limits, strict=True):
        top = max(high, -low * (1.0 - share) / share)
        side.set_ylim(-share / (1.0 - share) * top, top)


def _limit(axes: Axes, limit: float, unit: str, panel: Panel, samples: Samples) -> None:
    """Draw the limit, below 0 only where a curve comes near it."""
    curves = [curve for curve in panel.curves if samples.has(curve.column) and not curve.right]
    lowest = min(float(np.nanmin(samples.column(curve.column))) * curve.scale for curve in curves)
    axes.axhline(limit, color=VERMILION, linewidth=1.0, linestyle=":", label=f"limit {limit:g} {unit}")
    # A limit below 0 that no curve comes near would only compress the picture.
    if lowest < -0.1 * limit:
        axes.axhline(-limit, color=VERMILION, linewidth=1.0, linestyle=":")


def _seconds_active(event: InterlockEvent | FaultRecord, end: float) -> float:
    return (end if event.ended is None else to_seconds(event.ended)) - to_seconds(event.began)


def _shade(axes: Axes, events: Sequence[InterlockEvent], samples: Samples) -> None:
    """Shade the time in which an interlock was active, once, however many were at that time."""
    end = to_seconds(samples[-1].at)
    shaded: list[tuple[float, float]] = []
    for event in sorted(events, key=lambda event: event.began):
        began = to_seconds(event.began)
        ended = began + _seconds_active(event, end)
        if shaded and began <= shaded[-1][1]:
            began = shaded[-1][0]
            ended = max(ended, shaded.pop()[1])
        shaded.append((began, ended))
    for index, (began, ended) in enumerate(shaded):
        label = "interlock active, see interlocks.png" if index == 0 else None
        axes.axvspan(began, ended, color=SKY, alpha=0.16, linewidth=0, label=label)


def _finish_time(axes: Axes, samples: Samples) -> None:
    time = samples.seconds
    axes.set_xlim(time[0], max(time[-1], time[0] + 0.1))
