"""Four pictures of a run for people: the path, the speeds, the currents and the holds.

The same rows give the same bytes: no date, no random colour, no window system.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from textwrap import shorten
from typing import Final, TypeAlias

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import Normal, Stroke
from matplotlib.ticker import MaxNLocator

from emulators.bench.records import HoldRecord, Sample
from firmware_bridge.robot import Robot
from firmware_bridge.units import to_seconds

# Okabe and Ito's palette: told apart with every common kind of colour blindness, and in grey by lightness.
BLUE: Final = "#0072B2"
ORANGE: Final = "#E69F00"
GREEN: Final = "#009E73"
VERMILION: Final = "#D55E00"
PURPLE: Final = "#CC79A7"
SKY: Final = "#56B4E9"
INK: Final = "#222222"
PALE: Final = "#9A9A9A"
AXIS_COLOURS: Final = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)

STYLE: Final = Path(__file__).with_name("bench.mplstyle")

HALO: Final = (Stroke(linewidth=2.5, foreground="white"), Normal())
"""Keeps a word readable where it crosses a line."""
MOVING_MPS: Final = 0.01
LEAST_CURRENT_A: Final = 0.1
"""A picture's current axis reaches at least this far, or noise would look like a load."""
REASON_LETTERS: Final = 70

Draw: TypeAlias = Callable[[Figure, Robot, Sequence[Sample], Sequence[HoldRecord]], None]


def draw(
    folder: Path, title: str, robot: Robot, samples: Sequence[Sample], holds: Sequence[HoldRecord]
) -> list[Path]:
    """Write one PNG for each picture into `folder` and return their paths; no rows, no pictures."""
    written = []
    for name, picture in PICTURES.items() if samples else ():
        with style.context(STYLE):
            figure = Figure(layout="constrained")
            FigureCanvasAgg(figure)
            picture(figure, robot, samples, holds)
            figure.suptitle(title, x=0.01, ha="left", fontsize=9.5, color=PALE)
            path = folder / f"{name}.png"
            figure.savefig(path, metadata={"Software": None})
            written.append(path)
    return written


def _path(figure: Figure, _robot: Robot, samples: Sequence[Sample], holds: Sequence[HoldRecord]) -> None:
    figure.set_size_inches(7.6, 7.4)
    axes = figure.add_subplot()
    x, y = [row.x_m for row in samples], [row.y_m for row in samples]
    axes.plot(x, y, color=BLUE, linewidth=3.2, alpha=0.45, label="plant", solid_capstyle="round")
    axes.plot(
        [row.odometry_x_m for row in samples],
        [row.odometry_y_m for row in samples],
        color=INK,
        linewidth=1.0,
        label="odometry",
    )
    _time_marks(axes, samples)
    began = {hold.began // 10_000_000 for hold in holds}
    held = [row for row in samples if row.at // 10_000_000 in began and abs(row.speed_mps) > MOVING_MPS]
    if held:
        axes.scatter(
            [row.x_m for row in held],
            [row.y_m for row in held],
            marker="X",
            s=46,
            color=VERMILION,
            edgecolor="white",
            linewidth=0.6,
            zorder=4,
            label="a hold began",
        )
    axes.scatter(
        x[:1], y[:1], s=54, facecolor="white", edgecolor=GREEN, linewidth=2.0, zorder=5, label="start"
    )
    axes.scatter(x[-1:], y[-1:], s=54, color=GREEN, zorder=5, label="end")
    _square(axes, x, y)
    axes.set(
        title="Path of the rear axle's middle", xlabel="x, forward at the start [m]", ylabel="y, left [m]"
    )
    axes.legend(loc="best")


def _time_marks(axes: Axes, samples: Sequence[Sample]) -> None:
    """Write the time beside the path, some eight times, but not twice at one place."""
    last: tuple[float, float] | None = None
    span = max(_extent([row.x_m for row in samples]), _extent([row.y_m for row in samples]), 0.1)
    step = max(len(samples) // 8, 1)
    for row in samples[step::step]:
        if last is not None and math.dist(last, (row.x_m, row.y_m)) < span * 0.07:
            continue
        last = (row.x_m, row.y_m)
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


def _square(axes: Axes, x: Sequence[float], y: Sequence[float]) -> None:
    """Give both directions one scale, and room around a path that is a line."""
    half = max(_extent(x), 0.2) * 0.5, max(_extent(y), 0.2) * 0.5
    half = max(half[0], half[1] * 0.35), max(half[1], half[0] * 0.35)
    for limits, values, reach in ((axes.set_xlim, x, half[0]), (axes.set_ylim, y, half[1])):
        middle = (max(values) + min(values)) * 0.5
        limits(middle - reach * 1.12, middle + reach * 1.12)
    axes.set_aspect("equal")


def _speeds(figure: Figure, robot: Robot, samples: Sequence[Sample], holds: Sequence[HoldRecord]) -> None:
    figure.set_size_inches(10.0, 8.0)
    speed, turn, lift = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 1.4))
    time = _times(samples)
    _shade(speed, holds, samples)
    limit = robot.limits.speed_mps
    speed.axhline(limit, color=VERMILION, linewidth=1.0, linestyle=":", label=f"limit {limit:g} m/s")
    if min(row.speed_mps for row in samples) < -0.1 * limit:
        speed.axhline(-limit, color=VERMILION, linewidth=1.0, linestyle=":")
    speed.plot(
        time,
        [row.demanded_speed_mps for row in samples],
        color=ORANGE,
        label="demanded",
        drawstyle="steps-post",
    )
    speed.plot(time, [row.speed_mps for row in samples], color=BLUE, label="plant")
    speed.set(title="Forward speed", ylabel="speed [m/s]")
    turn.plot(
        time,
        np.degrees([row.steer_rad for row in samples]),
        color=GREEN,
        label="steer angle, inner wheel [°]",
    )
    turn.plot(time, np.degrees([row.yaw_rate_rad_s for row in samples]), color=PURPLE, label="yaw rate [°/s]")
    turn.set(title="Turning, left is positive", ylabel="[°], [°/s]")
    lift.plot(time, [row.lift_m * 1000.0 for row in samples], color=BLUE, label="height above collapsed")
    lift.set(title="Lift", ylabel="height [mm]", xlabel="time [s]")
    lift.set_ylim(bottom=min(-5.0, *lift.get_ylim()), top=max(20.0, *lift.get_ylim()))
    for axes in (speed, turn):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.99), borderaxespad=0.0, ncols=4, fontsize=8.5)
    figure.align_ylabels()
    _finish_time(lift, time)


def _currents(figure: Figure, robot: Robot, samples: Sequence[Sample], _holds: Sequence[HoldRecord]) -> None:
    figure.set_size_inches(10.0, 1.2 + 1.7 * len(robot.axes))
    time = _times(samples)
    rows = figure.subplots(len(robot.axes), 1, sharex=True, squeeze=False)[:, 0]
    for index, (axis, axes) in enumerate(zip(robot.axes, rows, strict=True)):
        current = np.array([row.currents_a[index] for row in samples])
        axes.plot(time, current, color=AXIS_COLOURS[index % len(AXIS_COLOURS)], linewidth=1.1)
        rms = math.sqrt(float(np.mean(current**2)))
        most = float(np.abs(current).max())
        axes.set(title=f"{axis.title.capitalize()}, node {axis.node}", ylabel="current [A]")
        continuous = axis.continuous_current_ma / 1000.0
        note = f"rms {rms:.2f} A, peak {most:.2f} A, continuous limit {continuous:g} A"
        axes.text(
            1.0, 1.02, note, transform=axes.transAxes, ha="right", va="bottom", color=PALE, fontsize=8.5
        )
        if most > 0.7 * continuous:
            for edge in (continuous, -continuous):
                axes.axhline(edge, color=VERMILION, linewidth=1.0, linestyle=":")
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, -LEAST_CURRENT_A), max(high, LEAST_CURRENT_A))
        axes.yaxis.set_major_locator(MaxNLocator(5))
    _finish_time(rows[-1], time)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()


def _holds(figure: Figure, _robot: Robot, samples: Sequence[Sample], holds: Sequence[HoldRecord]) -> None:
    names = list(dict.fromkeys(hold.name for hold in holds))
    figure.set_size_inches(10.0, 1.6 + 0.55 * len(names))
    axes = figure.add_subplot()
    end = to_seconds(samples[-1].at)
    for row, name in enumerate(names):
        rows = [hold for hold in holds if hold.name == name]
        bars = [(to_seconds(hold.began), _seconds_held(hold, end)) for hold in rows]
        shortest = end / 400.0  # so that a hold of one cycle is seen at all
        axes.broken_barh(
            [(began, max(length, shortest)) for began, length in bars],
            (row - 0.2, 0.62),
            facecolor=AXIS_COLOURS[row % len(AXIS_COLOURS)],
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
    armed = [(to_seconds(row.at), 0.01) for row in samples if row.armed]
    axes.broken_barh(armed, (len(names) - 0.18, 0.36), facecolor=PALE)
    axes.set_yticks(range(len(names) + 1), [name.replace("_", " ") for name in names] + ["(armed)"])
    axes.set_ylim(len(names) + 0.6, -0.6)
    axes.grid(visible=False, axis="y")
    axes.set(title="Which interlock held, and when", xlabel="time [s]")
    _finish_time(axes, _times(samples))


def _times(samples: Sequence[Sample]) -> list[float]:
    return [to_seconds(row.at) for row in samples]


def _seconds_held(hold: HoldRecord, end: float) -> float:
    return (end if hold.ended is None else to_seconds(hold.ended)) - to_seconds(hold.began)


def _shade(axes: Axes, holds: Sequence[HoldRecord], samples: Sequence[Sample]) -> None:
    end = to_seconds(samples[-1].at)
    for index, hold in enumerate(holds):
        began = to_seconds(hold.began)
        label = "a hold" if index == 0 else None
        axes.axvspan(began, began + _seconds_held(hold, end), color=SKY, alpha=0.13, linewidth=0, label=label)


def _finish_time(axes: Axes, time: Sequence[float]) -> None:
    axes.set_xlim(time[0], max(time[-1], time[0] + 0.1))


def _extent(values: Sequence[float]) -> float:
    return max(values) - min(values)


PICTURES: Final[Mapping[str, Draw]] = {
    "path": _path,
    "speeds": _speeds,
    "currents": _currents,
    "holds": _holds,
}
