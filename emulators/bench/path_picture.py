"""The path of a run: the plant's and the odometry's, with the time beside it."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from emulators.bench.columns import ODOMETRY, PLANAR, POSE, SAMPLE_EVERY, Floats, Sample, Samples
from emulators.bench.halo import HALO
from emulators.bench.records import InterlockEvent
from emulators.bench.style import BLUE, GREEN, INK, VERMILION
from firmware_bridge.units import to_seconds

MOVING_MPS: Final = 0.01


def path_picture(figure: Figure, samples: Samples, events: Sequence[InterlockEvent]) -> None:
    """Draw the robot's path, where a plant provides it, and its path by the bridge's own odometry."""
    figure.set_size_inches(7.6, 7.4)
    axes = figure.add_subplot()
    place = (POSE if samples.truth else ODOMETRY)[:2]
    known = np.isfinite(samples.column(place[0]))
    x, y = (samples.column(name)[known] for name in place)
    if samples.truth:
        axes.plot(x, y, color=BLUE, linewidth=3.2, alpha=0.45, label="actual (plant)", solid_capstyle="round")
    # NaN before the bridge knows its pose: the line begins there.
    estimated = [samples.column(name) for name in ODOMETRY[:2]]
    axes.plot(*estimated, color=INK, linewidth=0.7 if samples.truth else 1.6, label="odometry of the bridge")
    rows = [row for row, it in zip(samples, known, strict=True) if it]
    _time_marks(axes, rows, place, max(_extent(x), _extent(y), 0.1))
    began = {event.began // SAMPLE_EVERY for event in events}
    tripped = [row for row in rows if row.at // SAMPLE_EVERY in began and abs(row["speed_mps"]) > MOVING_MPS]
    if tripped:
        axes.scatter(
            [row[place[0]] for row in tripped],
            [row[place[1]] for row in tripped],
            marker="X",
            s=46,
            color=VERMILION,
            edgecolor="white",
            linewidth=0.6,
            zorder=4,
            label="an interlock became active",
        )
    axes.scatter(
        x[:1], y[:1], s=54, facecolor="white", edgecolor=GREEN, linewidth=2.0, zorder=5, label="start"
    )
    axes.scatter(x[-1:], y[-1:], s=54, color=GREEN, zorder=5, label="end")
    _square(axes, x, y)
    axes.set(
        title="Path of the reference point" if samples.truth else "Path by the bridge's odometry",
        xlabel=_named(samples, "x_m", "x, forward at the start"),
        ylabel=_named(samples, "y_m", "y, left"),
    )
    # Below the plot: within it, most paths would cross it.
    figure.legend(loc="outside lower center", ncols=5, fontsize=8.5, columnspacing=1.2)


def _named(samples: Samples, name: str, planar: str) -> str:
    """Return the axis' label: of a robot that drives on no plane, the column's own title."""
    known = {column.name: column for column in samples.columns}
    column = known.get(name)
    own = column is not None and column not in PLANAR
    return f"{column.title if column is not None and own else planar} [m]"


def _time_marks(axes: Axes, rows: Sequence[Sample], place: tuple[str, ...], span: float) -> None:
    """Write the time beside the path, some eight times, but not twice at one place."""
    last: tuple[float, float] | None = None
    step = max(len(rows) // 8, 1)
    for row in rows[step::step]:
        here = row[place[0]], row[place[1]]
        if last is not None and math.dist(last, here) < span * 0.07:
            continue
        last = here
        axes.plot(*last, marker="o", markersize=4, color=BLUE)
        axes.annotate(
            f"{to_seconds(row.at):.0f} s",
            last,
            xytext=(6, 5),
            textcoords="offset points",
            color=BLUE,
            fontsize=8.5,
            path_effects=HALO,
        )


def _square(axes: Axes, x: Floats, y: Floats) -> None:
    """Give both directions one scale, and room around a path that is a line."""
    half = max(_extent(x), 0.2) * 0.5, max(_extent(y), 0.2) * 0.5
    half = max(half[0], half[1] * 0.35), max(half[1], half[0] * 0.35)
    for limits, values, reach in ((axes.set_xlim, x, half[0]), (axes.set_ylim, y, half[1])):
        middle = float(values.max() + values.min()) * 0.5 if values.size else 0.0
        limits(middle - reach * 1.12, middle + reach * 1.12)
    axes.set_aspect("equal")


def _extent(values: Floats) -> float:
    return float(values.max() - values.min()) if values.size else 0.0
