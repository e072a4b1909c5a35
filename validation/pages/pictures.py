"""The README's pictures, made by the product: a run's path, and the monitor's display of its bus.

`python -m validation.pages.pictures` drives the run and writes both to docs/pictures.
"""

import io
import re
import shutil
import tempfile
from pathlib import Path
from typing import Final

from rich._export_format import CONSOLE_SVG_FORMAT
from rich.console import Console

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.run import RunOrder, drive
from firmware_bridge.cli.monitor_table import drawn
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.dissector.expected import can_links, expected_on
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.recording import parse_candump
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find

FOLDER: Final = Path(__file__).parents[2] / "docs" / "pictures"
ROBOT: Final = "diff_drive"
MISSION: Final = "figure_eight"
WIDTH: Final = 110


def monitor_of(log: Path, robot: AnyRobot) -> str:
    """Return the monitor's display of a recorded bus, as SVG."""
    (link,) = can_links(robot)
    picture = BusPicture(Epos2Link.of_link(robot, link).bit_rate, tuple(expected_on(robot, link)))
    for line in log.read_text(encoding="utf-8").splitlines():
        at, _, packet = parse_candump(line)
        picture.note(at, packet)
    console = Console(width=WIDTH, record=True, file=io.StringIO(), force_terminal=True)
    console.print(drawn(picture))
    title = f"firmware-bridge monitor --log can.log --robot {robot.name}"
    # Rich's own format takes its font from an address outside.
    plain = re.sub(r"@font-face \{\{.*?\}\}\s*", "", CONSOLE_SVG_FORMAT, flags=re.DOTALL)
    return console.export_svg(title=title, code_format=plain, unique_id="monitor")


def main() -> None:
    """Drive the run, and write its path and its bus as the monitor shows it."""
    robot = find(ROBOT, plant_too=True)
    setup = bench_setup_of(robot)
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        mission = missions.find(MISSION, robot, setup)
        drive(RunOrder(robot, setup, MISSION, mission, 0, folder), lambda _now: None)
        shutil.copy(folder / "path.png", FOLDER / "path.png")
        (FOLDER / "monitor.svg").write_text(monitor_of(folder / "can.log", robot), encoding="utf-8")


if __name__ == "__main__":
    main()
