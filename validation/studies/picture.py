"""A study's plots as SVG and PNG, the same bytes each time: no date, no window system."""

from collections.abc import Mapping
from io import BytesIO
from typing import Any, Final

from matplotlib import rc_context, style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from emulators.bench.style import AXIS_COLORS, STYLE
from validation.studies.study import Plot

SIZE: Final = (7.4, 4.4)
SQUARE: Final = (7.4, 6.2)
"""Inches, of a plot with both axes on one scale."""
LOOKS: Final[Mapping[str, Mapping[str, Any]]] = {
    "line": {"linestyle": "-"},
    "dashed": {"linestyle": "--"},
    "dots": {"linestyle": ":"},
    "points": {"linestyle": "", "marker": "o", "markersize": 4.5},
}


def pictures(plot: Plot) -> tuple[bytes, bytes]:
    """Return the plot as SVG and as PNG."""
    with style.context(STYLE), rc_context({"svg.hashsalt": plot.title}):
        figure = Figure(figsize=SQUARE if plot.equal else SIZE, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        for place, curve in enumerate(plot.curves):
            color = AXIS_COLORS[place % len(AXIS_COLORS)]
            axes.plot(curve.x, curve.y, color=color, label=curve.label or None, **LOOKS[curve.style])
        axes.set(title=plot.title, xlabel=plot.x, ylabel=plot.y)
        if plot.equal:
            axes.set_aspect("equal", adjustable="datalim")
        if any(curve.label for curve in plot.curves):
            figure.legend(loc="outside lower center", ncols=2, fontsize=8.5)
        vector, raster = BytesIO(), BytesIO()
        figure.savefig(vector, format="svg", metadata={"Date": None})
        figure.savefig(raster, format="png", metadata={"Software": None})
    return vector.getvalue(), raster.getvalue()
