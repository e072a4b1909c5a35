"""Drives a mission, with a progress bar, and shows its summary."""

import shlex
import sys
from pathlib import Path
from typing import Final

from emulators.bench import mission as missions
from emulators.bench.along import along_mission
from emulators.bench.mission import MissionFileError
from emulators.bench.rehearsal import rehearsal_of
from emulators.bench.report import show
from emulators.cli.beginning import tell_of_beginning
from emulators.cli.bench import BenchOptions
from emulators.cli.fitted import fitted
from emulators.extras import cure, installed
from emulators.progress_bar import progress_bar
from emulators.run import Order, drive
from emulators.servo.bank import ServoError
from firmware_bridge.cli.console import one_message, say, written_by
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.cli.tables import terminal
from firmware_bridge.drivers.epos2.serial.plan import PlanError
from firmware_bridge.drivers.shield.plan import ShieldPlanError
from firmware_bridge.pilot.paths import PathError
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot.path_file import PathFileError
from firmware_bridge.slow_link.conditions import ConditionsError
from fmu.errors import PlantError

RESULTS: Final = Path("out")


def bench(given: BenchOptions) -> None:
    """Do what `bench` says; what is wrong ends the program with a message."""
    with (
        one_message(
            *(MissionFileError, RobotFileError, PathFileError, PlanError, ShieldPlanError),
            *(PlantError, ServoError, LookupError, ConditionsError, PathError),
        ),
        written_by("--out"),
    ):
        machine, along = fitted(find_robot(given.robot), given)
        rehearsal = rehearsal_of(machine)
        if given.mission is None and along:
            name, script = "path", missions.parse(along_mission(along), "--path", machine, rehearsal)
        else:
            chosen = given.mission or next(iter(rehearsal.shipped()), "none")
            name, script = Path(chosen).stem, missions.find(chosen, machine, rehearsal)
        script = script.over(given.link, given.max_delay)
        script = script.predicted() if given.predictor else script
        script.on(machine)
        folder = given.out or RESULTS / f"{machine.name}-{name}"
        order = Order(machine, rehearsal, name, script, given.seed, folder, given.plant, _again())
        tell_of_beginning(machine, given.plant)
        if not installed("plots"):
            say(f"no pictures this time: {cure('plots')}", err=True)
        with progress_bar() as bar:
            task = bar.add_task(f"{machine.name}, {name}", total=order.duration)
            summary = drive(order, lambda now: bar.update(task, completed=now))
    show(terminal(), summary, rehearsal.remarks(machine))
    say(f"results: {folder}/")


def _again() -> str:
    """Return the line that was typed."""
    return shlex.join(("firmware-bridge", *sys.argv[1:]))
