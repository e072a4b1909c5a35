"""`bench`: a mission in virtual time, at the command line."""

import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.cli.bench_realtime import check, in_real_time, stations_mission
from emulators.cli.options import PlantOption, RunFileOption, SerialOption, run_file
from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.console import FAILED, one_message, refusal, say, written_by
from firmware_bridge.cli.options import (
    EncodersOption,
    FirmwareOption,
    MaxDelayOption,
    PathOption,
    PathSpeedOption,
    RobotArgument,
    SlowLinkOption,
)
from firmware_bridge.cli.plot_option import PlotOption

if TYPE_CHECKING:
    from emulators.bench.bench_setup import BenchSetup
    from emulators.bench.mission import Mission
    from emulators.bench.summary import Summary
    from emulators.run import RunOrder
    from firmware_bridge.robot import AnyRobot
    from firmware_bridge.robot.path_file import Point

EXAMPLES: Final = """Examples:

`firmware-bridge bench rars --mission line`

`firmware-bridge bench rars --mission line --serial v2` drives over the first drive's serial port.

`firmware-bridge bench rome --mission line --protocol arduinoio --encoders 3` drives over another firmware.

`firmware-bridge bench rome --path my_path.csv` lets the path follower drive along the points of a file.
`firmware-bridge bench rars --mission line --link delay=0.6,jitter=0.1,up.loss=0.02` drives over a slow link.

`firmware-bridge bench rars --mission pursuit --link delay=0.8 --predictor` follows a circle over the link.

`firmware-bridge bench rars --mission my_mission.toml --seed 7 --out results`

`firmware-bridge bench rars --mission line --realtime` takes faults by `firmware-bridge inject` as it runs.

`firmware-bridge bench rars --realtime --mavlink udpin:127.0.0.1:14550` is driven by a ground station.

`firmware-bridge bench rars --mission circles --realtime --live` is shown in a browser."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BenchOptions:
    """Drive a mission in virtual time: bridge, bus, drives and plant, all in this process.

    Writes `report.html` with all results on one page, `summary.json`, `samples.csv`, `can.log` (as candump),
    `serial.log`, `operator.tlog`, `capture.log` with cameras, and plots in the results'
    folder, which `replay` plays again.

    Exit status 0 after a run, whatever stopped the robot in it; 1 if the bridge did not start; 2 for a
    wrong argument, robot file or mission.
    """

    robot: RobotArgument
    mission: Annotated[
        str | None,
        typer.Option(
            "--mission",
            "-m",
            metavar="NAME|FILE",
            help="A shipped mission of the robot, or a mission file (.toml).",
            show_default="the robot's first; with --path one that drives along it",
            autocompletion=completing("emulators.bench.bench_setup:mission_names"),
        ),
    ] = None
    seed: Annotated[
        int,
        typer.Option(
            "--seed", "-s", min=0, help="Seed of all random numbers; the same seed gives the same run."
        ),
    ] = 0
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR", help="Folder of the results.", show_default="out/ROBOT-MISSION"
        ),
    ] = None
    record: RunFileOption = None
    plant: PlantOption = None
    serial: SerialOption = None
    link: SlowLinkOption = None
    max_delay: MaxDelayOption = None
    predictor: Annotated[
        bool,
        typer.Option("--predictor", help="Let the mission's pilot steer by the predicted pose."),
    ] = False
    protocol: FirmwareOption = None
    encoders: EncodersOption = None
    check: Annotated[
        bool,
        typer.Option("--check", help="Read robot and mission, report their mistakes, and drive nothing."),
    ] = False
    path: PathOption = None
    path_speed: PathSpeedOption = None
    realtime: Annotated[
        bool,
        typer.Option(
            "--realtime", help="At the clock's pace, with a control port for `inject`; Ctrl-C ends the run."
        ),
    ] = False
    control: Annotated[
        str | None,
        typer.Option(
            metavar="WHERE",
            help="Control port of --realtime, as of `emulate`: unix, tcp, tcp:PORT or none.",
            show_default="unix",
        ),
    ] = None
    mavlink: Annotated[
        str | None,
        typer.Option(
            metavar="LINK",
            help="With --realtime: ground stations of this machine drive in place of the mission's operator, "
            "udpout:127.0.0.1:14550 or udpin:127.0.0.1:PORT.",
        ),
    ] = None
    live: Annotated[
        bool,
        typer.Option(
            "--live",
            help="With --realtime: a page for a browser on this machine, which shows the bench, takes "
            "faults, pauses, rewinds and drives; its address is printed.",
        ),
    ] = False
    plotjuggler: PlotOption = None
    duration: Annotated[
        float | None,
        typer.Option(
            min=0.1, metavar="SECONDS", help="With --mavlink: end after this time.", show_default="an hour"
        ),
    ] = None


RESULTS: Final = Path("out")


def run(given: BenchOptions) -> None:
    """Run the command `bench`; an error ends the program with a message."""
    from emulators.bench.bench_setup import bench_setup_of
    from emulators.bench.mission import MissionFileError
    from emulators.bench.report import show
    from emulators.cli.beginning import report_beginning
    from emulators.cli.fitted import fitted
    from emulators.paced import OutsideOperator
    from emulators.run import RunOrder
    from emulators.servo.bank import ServoError
    from firmware_bridge.bridge.bridge import FAILED as NOT_STARTED
    from firmware_bridge.cli.recorded import with_bus
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.cli.tables import terminal
    from firmware_bridge.drivers.link_drivers import PlanError
    from firmware_bridge.extras import installed, remedy_of
    from firmware_bridge.pilot.paths import PathError
    from firmware_bridge.robot import RobotFileError
    from firmware_bridge.robot.path_file import PathFileError
    from firmware_bridge.robot.table import Medium
    from firmware_bridge.slow_link.conditions import ConditionsError
    from fmu.errors import PlantError

    check(given)
    record = run_file(given.record)
    with (
        one_message(
            *(MissionFileError, RobotFileError, PathFileError, PlanError),
            *(PlantError, ServoError, LookupError, ConditionsError, PathError),
        ),
        written_by("--out" if record is None else "--out or --record"),
    ):
        machine, along = fitted(find_robot(given.robot), given)
        bench_setup = bench_setup_of(machine)
        name, script = _script(given, along, machine, bench_setup)
        if record is not None:
            has_bus = any(link.medium is Medium.CAN for link in machine.links.values())
            with_bus(record, has_bus=has_bus, instead="a name that ends in .mcap")
        script = script.over(given.link, given.max_delay)
        script = script.predicted() if given.predictor else script
        # Only to check it: what is wrong is reported before the plant is built.
        script.on(machine)
        if given.check:
            say(f"{name}: good, for {machine.name}")
            return
        folder = given.out or RESULTS / f"{machine.name}-{name}"
        outside = None if given.mavlink is None else OutsideOperator()
        order = RunOrder(
            *(machine, bench_setup, name, script, given.seed, folder, given.plant, _again()),
            operator=outside,
            record=record,
        )
        report_beginning(machine, given.plant)
        if not installed("plots"):
            say(f"no pictures this time: {remedy_of('plots')}", err=True)
        summary = _driven(order, given)
    show(terminal(), summary, bench_setup.remarks(machine))
    say(f"results: {folder}/" + ("" if record is None else f", {record}"))
    for event in summary.interlock_events:
        # A bridge that did not start is no result: exit status 1.
        if event.name == NOT_STARTED.name:
            raise refusal(f"the run did not start: {event.reason}", FAILED)


def _script(
    given: BenchOptions, along: "tuple[Point, ...]", machine: "AnyRobot", bench_setup: "BenchSetup"
) -> "tuple[str, Mission]":
    """Return the mission and its name."""
    from emulators.bench import mission as missions
    from emulators.bench.along import along_mission

    if given.mission is None and along:
        return "path", missions.parse(along_mission(along), "--path", machine, bench_setup)
    if given.mission is None and given.mavlink is not None:
        text = stations_mission(given.duration)
        return "stations", missions.parse(text, "--mavlink", machine, bench_setup)
    chosen = given.mission or next(iter(bench_setup.shipped()), "none")
    script = missions.find(chosen, machine, bench_setup)
    return Path(chosen).stem, script if given.mavlink is None else script.driven_by_stations()


def _driven(order: "RunOrder", given: BenchOptions) -> "Summary":
    """Drive the mission, in virtual time or at the clock's pace."""
    from emulators.progress_bar import progress_bar
    from emulators.run import drive

    title = f"{order.robot.name}, {order.mission_name}"
    if given.realtime:
        return drive(order, lambda _now: None, in_real_time(given, order, title))
    with progress_bar() as bar:
        task = bar.add_task(title, total=order.duration)
        return drive(order, lambda now: bar.update(task, completed=now))


def _again() -> str:
    """Return the line that was typed."""
    return shlex.join(("firmware-bridge", *sys.argv[1:]))


bench: Final = command(EXAMPLES, work=run)(BenchOptions)
