"""Marks of faults in a picture over time: a shade from a fault's beginning to its end, and its name."""

from collections.abc import Sequence
from typing import Final

from matplotlib.axes import Axes

from emulators.bench.halo import HALO
from emulators.bench.records import FaultRecord
from emulators.bench.style import VERMILION
from firmware_bridge.units import to_seconds

LEAST_SHARE: Final = 1 / 400
"""Least share of the picture's width, so that an instant is seen at all."""


def mark_faults(
    rows: Sequence[Axes], faults: Sequence[FaultRecord], end_s: float, *, named: bool = True
) -> None:
    """Shade all rows of a picture, behind everything else, and name the faults in the first one."""
    for fault in faults:
        began = to_seconds(fault.began)
        ended = end_s if fault.ended is None else to_seconds(fault.ended)
        for axes in rows:
            least = began + LEAST_SHARE * end_s
            axes.axvspan(began, max(ended, least), color=VERMILION, alpha=0.18, linewidth=0, zorder=0)
        if not named:
            continue
        rows[0].annotate(
            fault.kind.replace("_", " "),
            (began, 0.98),
            xycoords=rows[0].get_xaxis_transform(),
            rotation=90,
            ha="right",
            va="top",
            fontsize=7.0,
            color=VERMILION,
            path_effects=HALO,
        )
