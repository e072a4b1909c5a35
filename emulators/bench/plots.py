"""Pictures of a run: the path, the robot's panels over time, motor currents, interlocks, and the robot's own.

The same rows give the same bytes: no date, no random color, no window system.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from matplotlib import style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from emulators.bench import margin
from emulators.bench.columns import Panel, Samples, current
from emulators.bench.fault_marks import mark_faults
from emulators.bench.path_picture import path_picture
from emulators.bench.records import FaultRecord, InterlockEvent
from emulators.bench.style import PALE, STYLE
from emulators.bench.time_pictures import currents_picture, interlocks_picture, panels_picture
from firmware_bridge.robot import AnyRobot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Picture: TypeAlias = Callable[[Figure, AnyRobot, Samples], None]
NO_PICTURES: Final[Mapping[str, Picture]] = MappingProxyType({})
OVER_TIME: Final = {"speeds": True, "currents": True, "interlocks": False}
"""Pictures whose axes are seconds, and whether faults are named at their marks, or else by rows."""


def draw(
    folder: Path,
    title: str,
    robot: AnyRobot,
    panels: Sequence[Panel],
    samples: Samples,
    *,
    events: Sequence[InterlockEvent],
    faults: Sequence[FaultRecord] = (),
    more: Mapping[str, Picture] = NO_PICTURES,
) -> list[Path]:
    """Write one PNG for each picture into `folder` and return their paths; no rows, no pictures.

    `more` are the robot's own.
    """
    panels = (*panels, *margin.panels(robot))
    currents_known = any(samples.has(current(axis.name)) for axis in robot.axes)
    pictures: Mapping[str, Callable[[Figure], None]] = {
        "path": lambda figure: path_picture(figure, samples, events),
        "speeds": lambda figure: panels_picture(figure, robot, panels, samples, events),
        **({"currents": lambda figure: currents_picture(figure, robot, samples)} if currents_known else {}),
        "interlocks": lambda figure: interlocks_picture(figure, samples, events, faults),
        # A robot's own picture is of its plant.
        **{name: partial(_own, picture, robot, samples) for name, picture in more.items() if samples.truth},
    }
    written = []
    for name, picture in pictures.items() if len(samples) else ():
        with style.context(STYLE):
            figure = Figure(layout="constrained")
            FigureCanvasAgg(figure)
            picture(figure)
            if name in OVER_TIME:
                rows: dict[object, Axes] = {}
                # A second vertical axis has the place of the first one, which is marked once.
                for axes in figure.axes:
                    rows.setdefault(axes.get_subplotspec(), axes)
                mark_faults(list(rows.values()), faults, float(samples.seconds[-1]), named=OVER_TIME[name])
            figure.suptitle(title, x=0.01, ha="left", fontsize=9.5, color=PALE)
            path = folder / f"{name}.png"
            figure.savefig(path, metadata={"Software": None})
            written.append(path)
    return written


def _own(picture: Picture, robot: AnyRobot, samples: Samples, figure: Figure) -> None:
    picture(figure, robot, samples)
