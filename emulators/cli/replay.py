"""`replay`: a recording played again, and the first packet that differs, at the command line."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from emulators.cli.options import SerialOption
from emulators.replay import RecordingFileError, ReplayOrder
from emulators.replay import replay as play
from emulators.replay.order import Into
from emulators.servo.bank import ServoError
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import FAILED, one_message, refusal, say
from firmware_bridge.cli.options import (
    EncodersOption,
    FirmwareOption,
    HomeOption,
    MaxDelayOption,
    PathOption,
    PathSpeedOption,
    RobotArgument,
    ZeroOption,
)
from firmware_bridge.dissector.canopen import SERVICE_NAMES
from firmware_bridge.drivers.link_drivers import PlanError
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot.path_file import PathFileError
from firmware_bridge.units import MICROSECOND, from_seconds, to_seconds
from fmu.errors import PlantError

EXAMPLES: Final = """Examples:

`firmware-bridge replay out/rars-line/can.log rars` plays the bridge's frames into emulated drives.

`firmware-bridge replay out/rars-line/can.log rars --operator out/rars-line/operator.tlog` plays the
frames of drives and operator into the bridge.

`firmware-bridge replay out/rome-circle rome` plays all recordings of a run's folder into the bridge: CAN
log, serial lines, cameras, operator.

`firmware-bridge replay out/rome-circle rome --protocol mw --encoders 3` plays it with the options of the run.

`firmware-bridge replay out/rars-line/operator.tlog rars` plays the operator's messages into the whole bench.

`firmware-bridge replay robot.log rars --without pdo --tolerance-us 5000` suits a candump log of a bus.

`--zero`, `--home`, `--max-delay`, `--serial`, `--protocol`, `--encoders` and `--path` are those of `bench` or
`drive`. A real run is played until its end was requested, by its folder's events.log; without that file use
`--until` to omit the shutdown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayOptions:
    """Play a recording again in virtual time, and show the first packet that differs from it.

    Exit status 0 where none differs, 1 where one does, 2 for a recording that cannot be used.
    """

    recording: Annotated[
        Path,
        typer.Argument(
            metavar="RECORDING",
            help="The folder of a run, as `bench` and `drive --record` write it; or a CAN log as "
            "`candump -l` writes it, what lines have carried (serial.log), or a telemetry log (.tlog); "
            "also .gz, .xz.",
            show_default=False,
        ),
    ]
    robot: RobotArgument
    into: Annotated[
        Into | None,
        typer.Option(
            help="Target of the replay: the drives, the bridge, or both on the bench.",
            show_default="drives for a CAN log, bridge with --operator, for lines and for a folder, "
            "bench for a telemetry log",
        ),
    ] = None
    operator: Annotated[
        Path | None,
        typer.Option(
            metavar="TLOG",
            help="The operator's messages beside a CAN log or lines.",
            show_default="the folder's",
        ),
    ] = None
    channel: Annotated[
        str | None,
        typer.Option("--channel", "-c", help="Bus of a CAN log with several buses.", show_default=False),
    ] = None
    until: Annotated[
        float | None,
        typer.Option(min=0.0, metavar="SECONDS", help="Omit packets recorded later.", show_default="the end"),
    ] = None
    tolerance_us: Annotated[float, typer.Option(min=0.0, help="Tolerance of a frame's time.")] = 0.0
    without: Annotated[
        list[str] | None,
        typer.Option(metavar="SERVICE", help=f"Do not compare: {', '.join(SERVICE_NAMES)}; may be repeated."),
    ] = None
    zero: ZeroOption = None
    home: HomeOption = None
    max_delay: MaxDelayOption = None
    serial: SerialOption = None
    protocol: FirmwareOption = None
    encoders: EncodersOption = None
    path: PathOption = None
    path_speed: PathSpeedOption = None
    plant: Annotated[
        Path | None,
        typer.Option(metavar="FMU", help="Another plant below the drives.", show_default=False),
    ] = None


def run(given: ReplayOptions) -> None:
    """Run the command `replay`; an error ends the program with a message."""
    from emulators.cli.fitted import fitted
    from emulators.progress_bar import progress_bar
    from emulators.replay.files import named
    from emulators.replay.recordings import cut_off
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.cli.zeros import zeros_of

    with one_message(RobotFileError, PathFileError):
        machine, _ = fitted(find_robot(given.robot).agreed_on(given.max_delay), given)
    for name in given.without or ():
        if name not in SERVICE_NAMES:
            raise refusal(f"--without {name}: no such service; there are: {', '.join(SERVICE_NAMES)}")
    with one_message(ValueError, OverflowError):
        limit = None if given.until is None else from_seconds(given.until)
    with one_message(RecordingFileError, PlanError, PlantError, ServoError):
        order = ReplayOrder(
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
        # Behind the replay: a recording that was cut off is good up to there.
        for text in filter(None, map(cut_off, named(order))):
            say(text)
    if outcome.difference is not None:
        say(outcome.difference)
        raise typer.Exit(FAILED)
    say(
        f"no difference: {outcome.compared} packets of the {outcome.into} are as recorded,"
        f" {outcome.played} others were played, in {to_seconds(outcome.until):.3f} s"
    )


replay: Final = command(EXAMPLES, work=run)(ReplayOptions)
