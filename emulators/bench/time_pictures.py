"""A run over time: the robot's own panels, currents, and active interlocks."""

import math
from collections.abc import Sequence
from textwrap import shorten
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from emulators.bench.columns import Curve, Panel, Samples, current
from emulators.bench.halo import HALO
from emulators.bench.records import InterlockEvent
from emulators.bench.style import (
    AXIS_COLORS,
    BLUE,
    GREEN,
    INK,
    ORANGE,
    PALE,
    PURPLE,
    SKY,
    VERMILION,
)
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import to_seconds

CURVE_COLORS: Final = (BLUE, GREEN, PURPLE, BLUE)
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
    colors = iter(CURVE_COLORS * len(panels))
    for axes, panel in zip(rows, panels, strict=True):
        if panel.shaded:
            _shade(axes, events, samples)
        if panel.limit is not None:
            _limit(axes, *panel.limit(robot), panel, samples)
        for curve in (one for one in panel.curves if samples.has(one.column)):
            _curve(axes, curve, samples, ORANGE if curve.step else next(colors))
        axes.set(title=panel.title, ylabel=panel.label)
        if panel.least:
            low, high = axes.get_ylim()
            axes.set_ylim(bottom=min(-panel.least / 4.0, low), top=max(panel.least, high))
        if len(axes.get_lines()) > 1:
            axes.legend(
                loc="lower right", bbox_to_anchor=(1.0, 0.99), borderaxespad=0.0, ncols=4, fontsize=8.5
            )
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    _finish_time(rows[-1], samples)


def currents_picture(figure: Figure, robot: AnyRobot, samples: Samples) -> None:
    """Draw each motor's current in a row of its own, where it is known."""
    known = [axis for axis in robot.axes if samples.has(current(axis.name))]
    figure.set_size_inches(10.0, 1.2 + 1.7 * len(known))
    rows = figure.subplots(len(known), 1, sharex=True, squeeze=False)[:, 0]
    for index, (axis, axes) in enumerate(zip(known, rows, strict=True)):
        drawn = samples.column(current(axis.name))
        axes.plot(samples.seconds, drawn, color=AXIS_COLORS[index % len(AXIS_COLORS)], linewidth=1.1)
        rms = math.sqrt(float(np.nanmean(drawn**2)))
        most = float(np.nanmax(np.abs(drawn)))
        axes.set(title=f"{axis.title.capitalize()}, {axis.settings.address}", ylabel="current [A]")
        continuous = axis.settings.continuous_current_ma / 1000.0
        note = f"rms {rms:.2f} A, peak {most:.2f} A, continuous limit {continuous:g} A"
        axes.text(
            1.0, 1.02, note, transform=axes.transAxes, ha="right", va="bottom", color=PALE, fontsize=8.5
        )
        # Far from the continuous current, its lines would only make the curve flat.
        if most > 0.7 * continuous:
            for edge in (continuous, -continuous):
                axes.axhline(edge, color=VERMILION, linewidth=1.0, linestyle=":")
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, -LEAST_CURRENT_A), max(high, LEAST_CURRENT_A))
        axes.yaxis.set_major_locator(MaxNLocator(5))
    _finish_time(rows[-1], samples)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()


def interlocks_picture(figure: Figure, samples: Samples, events: Sequence[InterlockEvent]) -> None:
    """Draw a row for each interlock, with its first reason."""
    names = list(dict.fromkeys(event.name for event in events))
    figure.set_size_inches(10.0, 1.6 + 0.55 * len(names))
    axes = figure.add_subplot()
    end = to_seconds(samples[-1].at)
    for row, name in enumerate(names):
        rows = [event for event in events if event.name == name]
        bars = [(to_seconds(event.began), _seconds_active(event, end)) for event in rows]
        shortest = end / 400.0  # so that an event of one cycle is seen at all
        axes.broken_barh(
            [(began, max(length, shortest)) for began, length in bars],
            (row - 0.2, 0.62),
            facecolor=AXIS_COLORS[row % len(AXIS_COLORS)],
        )
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
    axes.set_yticks(range(len(names) + 1), [name.replace("_", " ") for name in names] + ["(armed)"])
    axes.set_ylim(len(names) + 0.6, -0.6)
    axes.grid(visible=False, axis="y")
    axes.set(title="Active interlocks", xlabel="time [s]")
    _finish_time(axes, samples)


def _curve(axes: Axes, curve: Curve, samples: Samples, color: str) -> None:
    drawn = samples.column(curve.column) * curve.scale
    label = curve.label if samples.truth else curve.label.replace("plant", "measured")
    if curve.step:
        axes.plot(
            samples.seconds,
            drawn,
            color=color,
            linewidth=3.4,
            alpha=0.6,
            label=label,
            drawstyle="steps-post",
        )
    else:
        axes.plot(samples.seconds, drawn, color=color, linewidth=1.2, label=label)


def _limit(axes: Axes, limit: float, unit: str, panel: Panel, samples: Samples) -> None:
    """Draw the limit, below 0 only where a curve comes near it."""
    curves = [curve for curve in panel.curves if samples.has(curve.column)]
    lowest = min(float(np.nanmin(samples.column(curve.column))) * curve.scale for curve in curves)
    axes.axhline(limit, color=VERMILION, linewidth=1.0, linestyle=":", label=f"limit {limit:g} {unit}")
    # A limit below 0 that no curve comes near would only compress the picture.
    if lowest < -0.1 * limit:
        axes.axhline(-limit, color=VERMILION, linewidth=1.0, linestyle=":")


def _seconds_active(event: InterlockEvent, end: float) -> float:
    return (end if event.ended is None else to_seconds(event.ended)) - to_seconds(event.began)


def _shade(axes: Axes, events: Sequence[InterlockEvent], samples: Samples) -> None:
    """Shade the time in which anything held, once, however many interlocks held at that time."""
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
        label = "active interlock" if index == 0 else None
        axes.axvspan(began, ended, color=SKY, alpha=0.16, linewidth=0, label=label)


def _finish_time(axes: Axes, samples: Samples) -> None:
    time = samples.seconds
    axes.set_xlim(time[0], max(time[-1], time[0] + 0.1))
