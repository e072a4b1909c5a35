"""Mean and envelope of a curve that reverses faster than a picture's pixels can show.

A line through such samples becomes a solid block, in which neither the mean nor the extremes can be read. The
rule is measured, not a property of a signal's name: samples per pixel, and reversals beyond a line's width.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from emulators.bench.columns import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BIN_PIXELS: Final = 2.0
"""Width of a bin: that of a curve's line."""
LEAST_SAMPLES: Final = 5.0
"""Least samples in a bin, on average: fewer are shown by a line."""
LEAST_REVERSALS: Final = 2
"""A bin with fewer is a slope, a step or one peak: a line shows it."""
LEAST_SWING: Final = 0.02
"""Least swing between two reversals, as a share of the curve's range: about a line's width."""
LEAST_SHARE: Final = 0.05
"""Least share of bins that a line would fill."""
AXES_SHARE: Final = 0.9
"""Share of the figure's width that its axes have."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """Mean, least and largest value of each bin that has a sample."""

    seconds: Floats
    mean: Floats
    low: Floats
    high: Floats
    bin_s: float
    """Length of a bin."""


def envelope(seconds: Floats, values: Floats, pixels: float) -> Envelope | None:
    """Return the envelope for axes of so many pixels; None where a line shows the curve as well."""
    known = np.isfinite(values)
    bins = int(pixels / BIN_PIXELS)
    length = float(seconds[-1] - seconds[0]) if len(seconds) else 0.0
    if bins < 1 or length <= 0.0 or np.count_nonzero(known) < LEAST_SAMPLES:
        return None
    place = np.minimum(((seconds - seconds[0]) * bins / length).astype(int), bins - 1)
    counts = np.bincount(place[known], minlength=bins)
    low, high = np.full(bins, np.inf), np.full(bins, -np.inf)
    np.minimum.at(low, place[known], values[known])
    np.maximum.at(high, place[known], values[known])
    filled = counts > 0
    span = float(high[filled].max() - low[filled].min())
    reversals = np.bincount(place[known][_reversals(values[known], LEAST_SWING * span)], minlength=bins)
    solid = np.count_nonzero(reversals >= LEAST_REVERSALS)
    if counts[filled].mean() < LEAST_SAMPLES or solid < LEAST_SHARE * np.count_nonzero(filled):
        return None
    sums = np.bincount(place[known], weights=values[known], minlength=bins)
    # A bin without a sample stays NaN: the line has a gap there, as the samples have.
    low[~filled] = high[~filled] = np.nan
    mean = np.divide(sums, counts, out=np.full(bins, np.nan), where=filled)
    middles = seconds[0] + (np.arange(bins) + 0.5) * length / bins
    return Envelope(middles, mean, low, high, length / bins)


def _reversals(values: Floats, swing: float) -> list[int]:
    """Return the indices of the extremes from which the values turn back by more than a swing."""
    found: list[int] = []
    extreme, rises = 0, True
    for index, value in enumerate(values.tolist()):
        ahead = value - values[extreme] if rises else values[extreme] - value
        if ahead >= 0.0:
            extreme = index
        elif -ahead > swing:
            found.append(extreme)
            extreme, rises = index, not rises
    return found


def draw_curve(
    axes: "Axes", seconds: Floats, values: Floats, color: str, label: str | None = None
) -> Envelope | None:
    """Draw a curve as a line, or as mean and envelope, which are returned then."""
    figure = axes.figure
    pixels = AXES_SHARE * float(figure.bbox.width)
    found = envelope(seconds, values, pixels)
    if found is None:
        axes.plot(seconds, values, color=color, linewidth=1.2, label=label)
        return None
    axes.fill_between(found.seconds, found.low, found.high, color=color, alpha=0.3, linewidth=0.4, step="mid")
    mean_label = label and f"{label}, mean"
    axes.plot(found.seconds, found.mean, color=color, linewidth=1.2, label=mean_label, drawstyle="steps-mid")
    return found


def band_label(found: Envelope) -> str:
    """Return the legend's text of an envelope."""
    return f"band: min to max per {found.bin_s:.2g} s"
