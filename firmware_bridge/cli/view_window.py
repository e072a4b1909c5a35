"""Draw what a robot's camera sees, from lines of poses on standard input: in a window, or into a file.

`python -m firmware_bridge.cli.view_window [FILE.png]`; the first line on standard output is "ready", or why
nothing can be drawn.
"""

import json
import os
import select
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

from firmware_bridge.extras import ExtraMissingError, from_extras
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.camera import Camera, Colors, change_of, warped
from firmware_bridge.pilot.room import Room, seen
from firmware_bridge.runtime.ports.view_window import READY

SMALLER: Final = 2
"""Drawn with half the sensor's columns and rows, so that ten pictures a second take little of the machine."""
EVENTS_S: Final = 0.05
MOST: Final = 65536


def main() -> int:
    """Draw until the input ends or the window is closed; exit status 1 where nothing can be drawn."""
    try:
        with from_extras():
            show = _file(Path(sys.argv[1])) if len(sys.argv) > 1 else _window()
    except (ExtraMissingError, OSError) as error:
        print(error, flush=True)  # noqa: T201 - the other program reads it
        return 1
    print(READY, flush=True)  # noqa: T201 - the other program reads it
    waiting = b""
    while show(None):
        if not select.select([sys.stdin], [], [], EVENTS_S)[0]:
            continue
        chunk = os.read(sys.stdin.fileno(), MOST)
        if not chunk:
            return 0
        *lines, waiting = (waiting + chunk).split(b"\n")
        # Only the newest is worth drawing.
        if lines and not show(drawn(lines[-1])):
            return 0
    return 0


def drawn(line: bytes) -> Colors:
    """Return the picture of a line: taken at one pose, and moved to the other where they differ."""
    poses = json.loads(line)
    picture, now = Pose(*poses["picture"]), Pose(*poses["now"])
    camera = Camera().smaller(SMALLER)
    made = seen(Room(), camera, picture)
    return made.color if now == picture else warped(camera, made, change_of(picture, now)).color


def _file(path: Path) -> Callable[[Colors | None], bool]:
    from matplotlib.image import imsave

    def show(color: Colors | None) -> bool:
        if color is not None:
            # Whole at any instant: another program watches it.
            part = path.with_suffix(".part.png")
            imsave(part, color)
            part.replace(path)
        return True

    if path.suffix != ".png" or not path.parent.is_dir():
        raise OSError(f"{path}: the picture needs a name that ends in .png, in a folder that exists")
    return show


def _window() -> Callable[[Colors | None], bool]:
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(num="firmware-bridge: the robot's view")
    if figure.canvas.required_interactive_framework is None:
        raise OSError("no window can be opened here; --view-to FILE.png keeps the picture in a file")
    camera = Camera().smaller(SMALLER)
    axes.set_axis_off()
    image = axes.imshow(seen(Room(), camera, Pose(0.0, 0.0, 0.0)).color)
    figure.show()

    def show(color: Colors | None) -> bool:
        if color is not None:
            image.set_data(color)
            figure.canvas.draw_idle()
        figure.canvas.flush_events()
        return plt.fignum_exists(figure.number)

    return show


if __name__ == "__main__":
    sys.exit(main())
