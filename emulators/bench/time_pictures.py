"""A run over time: speeds, currents, and which interlock held when."""

import math
from collections.abc import Sequence
from textwrap import shorten
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from emulators.bench.look import (
    AXIS_COLOURS,
    BLUE,
    GREEN,
    HALO,
    INK,
    ORANGE,
    PALE,
    PURPLE,
    SKY,
    VERMILION,
)
from emulators.bench.records import HoldRecord, Sample
from firmware_bridge.robot import Robot
from firmware_bridge.units import to_seconds

LEAST_CURRENT_A: Final = 0.1
"""A picture's current axis reaches at least this far, or noise would look like a load."""
REASON_LETTERS: Final = 70


def speeds_picture(
    figure: Figure, robot: Robot, samples: Sequence[Sample], holds: Sequence[HoldRecord]
) -> None:
    """Draw the forward speed, the turning and the lift."""
    figure.set_size_inches(10.0, 8.0)
    speed, turn, lift = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 1.4))
    time = _times(samples)
    _shade(speed, holds, samples)
    limit = robot.limits.speed_mps
    speed.axhline(limit, color=VERMILION, linewidth=1.0, linestyle=":", label=f"limit {limit:g} m/s")
    if min(row.speed_mps for row in samples) < -0.1 * limit:
        speed.axhline(-limit, color=VERMILION, linewidth=1.0, linestyle=":")
    demanded = [row.demanded_speed_mps for row in samples]
    speed.plot(
        time, demanded, color=ORANGE, linewidth=3.4, alpha=0.6, label="demanded", drawstyle="steps-post"
    )
    speed.plot(time, [row.speed_mps for row in samples], color=BLUE, linewidth=1.2, label="plant")
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


def currents_picture(
    figure: Figure, robot: Robot, samples: Sequence[Sample], _holds: Sequence[HoldRecord]
) -> None:
    """Draw each motor's current in a row of its own."""
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


def holds_picture(
    figure: Figure, _robot: Robot, samples: Sequence[Sample], holds: Sequence[HoldRecord]
) -> None:
    """Draw a row for each interlock, with its first reason."""
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
    """Shade the time in which anything held, once, however many interlocks held at that time."""
    end = to_seconds(samples[-1].at)
    shaded: list[tuple[float, float]] = []
    for hold in sorted(holds, key=lambda hold: hold.began):
        began = to_seconds(hold.began)
        ended = began + _seconds_held(hold, end)
        if shaded and began <= shaded[-1][1]:
            began = shaded[-1][0]
            ended = max(ended, shaded.pop()[1])
        shaded.append((began, ended))
    for index, (began, ended) in enumerate(shaded):
        label = "a hold" if index == 0 else None
        axes.axvspan(began, ended, color=SKY, alpha=0.16, linewidth=0, label=label)


def _finish_time(axes: Axes, time: Sequence[float]) -> None:
    axes.set_xlim(time[0], max(time[-1], time[0] + 0.1))
