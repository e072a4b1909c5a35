"""Drives a mission, with a progress bar, and shows its summary."""

from pathlib import Path
from typing import Final

from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from emulators.bench import mission as missions
from emulators.bench.mission import MissionFileError
from emulators.bench.report import show
from emulators.cli.beginning import tell_of_beginning
from emulators.run import Order, drive
from emulators.servo.bank import ServoError
from firmware_bridge.cli.console import one_message, say, written_by
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.cli.tables import terminal
from firmware_bridge.drivers.serial.plan import PlanError
from firmware_bridge.robot import RobotFileError
from firmware_bridge.wire.maxon.frame import Generation
from fmu.errors import PlantError

RESULTS: Final = Path("out")


def bench(
    robot: str, *, mission: str, seed: int, out: Path | None, plant: Path | None, serial: Generation | None
) -> None:
    """Do what `bench` says; what is wrong ends the program with a message."""
    machine = find_robot(robot)
    if serial is not None:
        machine = machine.over_serial(serial)
    with (
        one_message(MissionFileError, RobotFileError, PlanError, PlantError, ServoError),
        written_by("--out"),
    ):
        script = missions.find(mission, machine)
        name = Path(mission).stem
        folder = out or RESULTS / f"{machine.name}-{name}"
        order = Order(machine, name, script, seed, folder, plant)
        tell_of_beginning(machine, plant)
        with _bar() as bar:
            task = bar.add_task(f"{machine.name}, {name}", total=order.duration)
            summary = drive(order, lambda now: bar.update(task, completed=now))
    show(terminal(), summary, machine.limits)
    say(f"results: {folder}/")


def _bar() -> Progress:
    """Return a progress bar that shows on a terminal only."""
    console = terminal(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
        transient=True,
    )
