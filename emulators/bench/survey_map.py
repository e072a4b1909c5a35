"""The map of a survey in a run's folder: survey.csv, and survey.png where pictures can be drawn."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from emulators.bench.columns import Samples
from emulators.bench.survey_table import Survey, Surveyed, SurveyMission, csv_of, surveyed
from firmware_bridge.extras import installed
from firmware_bridge.node import Node

NAME: Final = "survey"


def mapped(operator: Node, samples: Samples, seed: int, folder: Path) -> list[Path]:
    """Write the map of a survey, and return its picture; nothing where the operator surveys nothing."""
    if not isinstance(operator, SurveyMission):
        return []
    rows = surveyed(operator.driver, operator.survey, samples, seed)
    (folder / f"{NAME}.csv").write_text(csv_of(rows), encoding="utf-8")
    if not installed("plots"):
        return []
    path = folder / f"{NAME}.png"
    _draw(path, rows, operator.survey)
    return [path]


def _draw(path: Path, rows: Sequence[Surveyed], survey: Survey) -> None:
    """Draw the readings from above, a panel for each height, and the emulated sources."""
    # Half a second, which no one needs before the run is over.
    from matplotlib import style  # noqa: PLC0415 - see above
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    from emulators.bench.style import INK, STYLE, VERMILION  # noqa: PLC0415

    read = [row for row in rows if row.believed is not None]
    most = max((row.per_s for row in read), default=1.0)
    with style.context(STYLE):
        figure = Figure(figsize=(7.6, 3.4 * len(survey.heights_m) + 0.6), layout="constrained")
        FigureCanvasAgg(figure)
        panels = figure.subplots(len(survey.heights_m), squeeze=False, sharex=True)[:, 0]
        for axes, height in zip(panels, survey.heights_m, strict=True):
            here = [row for row in read if row.believed and _nearest(row.believed[2], survey) == height]
            places = [row.believed[:2] for row in here if row.believed]
            shown = axes.scatter(
                *zip(*places, strict=True) if places else ((), ()),
                c=[row.per_s for row in here],
                s=90,
                vmin=0.0,
                vmax=most,
                edgecolor=INK,
                zorder=3,
            )
            for row, place in zip(here, places, strict=True):
                axes.annotate(f"{row.per_s:.0f}", place, textcoords="offset points", xytext=(8, 6))
            x, y = ([getattr(one, name) for one in survey.source] for name in ("x_m", "y_m"))
            axes.scatter(x, y, marker="*", s=110, color=VERMILION, zorder=2, label="emulated source")
            axes.set(
                title=f"counts a second, table {height:g} m up",
                ylabel="y, left [m]",
                aspect="equal",
            )
            axes.margins(0.25)
            figure.colorbar(shown, ax=axes, label="counts [1/s]")
        panels[-1].set_xlabel("x, ahead at the start [m]")
        if survey.source:
            figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center")
        figure.savefig(path, metadata={"Software": None})


def _nearest(height_m: float, survey: Survey) -> float:
    return min(survey.heights_m, key=lambda one: abs(one - height_m))
