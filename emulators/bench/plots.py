"""Four pictures of a run for people: the path, the speeds, the currents and the holds.

The same rows give the same bytes: no date, no random colour, no window system.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final, TypeAlias

from matplotlib import style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from emulators.bench.fault_marks import mark_faults
from emulators.bench.look import PALE, STYLE
from emulators.bench.path_picture import path_picture
from emulators.bench.records import FaultRecord, HoldRecord, Sample
from emulators.bench.time_pictures import currents_picture, holds_picture, speeds_picture
from firmware_bridge.robot import Robot
from firmware_bridge.units import to_seconds

Draw: TypeAlias = Callable[[Figure, Robot, Sequence[Sample], Sequence[HoldRecord]], None]

PICTURES: Final[Mapping[str, Draw]] = {
    "path": path_picture,
    "speeds": speeds_picture,
    "currents": currents_picture,
    "holds": holds_picture,
}

OVER_TIME: Final = {"speeds": True, "currents": True, "holds": False}
"""Pictures whose axes are seconds, and whether they have room for the names of faults."""


def draw(
    folder: Path,
    title: str,
    robot: Robot,
    samples: Sequence[Sample],
    holds: Sequence[HoldRecord],
    *,
    faults: Sequence[FaultRecord] = (),
) -> list[Path]:
    """Write one PNG for each picture into `folder` and return their paths; no rows, no pictures."""
    written = []
    for name, picture in PICTURES.items() if samples else ():
        with style.context(STYLE):
            figure = Figure(layout="constrained")
            FigureCanvasAgg(figure)
            picture(figure, robot, samples, holds)
            if name in OVER_TIME:
                mark_faults(figure.axes, faults, to_seconds(samples[-1].at), named=OVER_TIME[name])
            figure.suptitle(title, x=0.01, ha="left", fontsize=9.5, color=PALE)
            path = folder / f"{name}.png"
            figure.savefig(path, metadata={"Software": None})
            written.append(path)
    return written
