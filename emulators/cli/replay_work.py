"""Plays a recording again and says what came of it."""

import typer

from emulators.cli.fitted import fitted
from emulators.cli.replay import ReplayOptions
from emulators.progress_bar import progress_bar
from emulators.replay import Order, RecordingFileError
from emulators.replay import replay as play
from emulators.servo.bank import ServoError
from firmware_bridge.cli.console import FAILED, one_message, refusal, say
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.cli.zeros import zeros_of
from firmware_bridge.dissector.canopen import SERVICE_NAMES
from firmware_bridge.drivers.epos2.serial.plan import PlanError
from firmware_bridge.drivers.shield.plan import ShieldPlanError
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot.path_file import PathFileError
from firmware_bridge.units import MICROSECOND, from_seconds, to_seconds
from fmu.errors import PlantError


def replay(given: ReplayOptions) -> None:
    """Do what `replay` says; what is wrong ends the program with a message."""
    with one_message(RobotFileError, PathFileError):
        machine, _ = fitted(find_robot(given.robot).agreed_on(given.max_delay), given)
    for name in given.without or ():
        if name not in SERVICE_NAMES:
            raise refusal(f"--without {name}: no such service; there are: {', '.join(SERVICE_NAMES)}")
    with one_message(ValueError, OverflowError):
        limit = None if given.until is None else from_seconds(given.until)
    with one_message(RecordingFileError, PlanError, ShieldPlanError, PlantError, ServoError):
        order = Order(
            machine,
            given.recording,
            given.operator,
            given.into,
            given.channel,
            limit,
            round(given.tolerance_us * MICROSECOND),
            frozenset(given.without or ()),
            given.plant,
            zeros_of(given.zero, given.home),
        )
        with progress_bar() as bar:
            task = bar.add_task(given.recording.name, total=None)
            outcome = play(order, lambda now, end: bar.update(task, completed=now, total=end))
    if outcome.difference is not None:
        say(outcome.difference)
        raise typer.Exit(FAILED)
    say(
        f"no difference: {outcome.compared} packets of the {outcome.into} are as recorded,"
        f" {outcome.played} others were played, in {to_seconds(outcome.until):.3f} s"
    )
