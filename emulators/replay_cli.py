"""The command `replay`: a recording played again, and the first packet that differs."""

from pathlib import Path
from typing import Annotated, Final

import typer

from emulators.progress_bar import progress_bar
from emulators.replay import Into, Order, RecordingFileError
from emulators.replay import replay as play
from emulators.servo.bank import ServoError
from firmware_bridge.cli.console import FAILED, find_robot, one_message, refusal
from firmware_bridge.cli.options import RobotArgument
from firmware_bridge.dissector.canopen import SERVICE_NAMES
from firmware_bridge.drivers.serial.plan import PlanError
from firmware_bridge.units import MICROSECOND, from_seconds, to_seconds
from fmu.errors import PlantError

EXAMPLES: Final = """Examples:

`firmware-bridge replay out/rars-line/can.log rars` plays what the bridge has sent into emulated drives.

`firmware-bridge replay out/rars-line/can.log rars --operator out/rars-line/operator.tlog` plays what drives
and operator have sent into the bridge.

`firmware-bridge replay out/rars-line/operator.tlog rars` plays the operator's messages into the whole bench.

`firmware-bridge replay robot.log rars --without pdo --tolerance-us 5000` suits the bus of a real robot."""


def replay(
    recording: Annotated[
        Path,
        typer.Argument(
            metavar="RECORDING",
            help="A CAN log as `candump -l` and `bench` write it, or a telemetry log (.tlog); also .gz, .xz.",
            show_default=False,
        ),
    ],
    robot: RobotArgument,
    *,
    into: Annotated[
        Into | None,
        typer.Option(
            help="What the recording is played into: the drives, the bridge, or both of them on the bench.",
            show_default="drives for a CAN log, bridge with --operator, bench for a telemetry log",
        ),
    ] = None,
    operator: Annotated[
        Path | None,
        typer.Option(metavar="TLOG", help="The operator's messages beside a CAN log.", show_default=False),
    ] = None,
    channel: Annotated[
        str | None,
        typer.Option("--channel", "-c", help="Which bus, where a CAN log holds several.", show_default=False),
    ] = None,
    until: Annotated[
        float | None,
        typer.Option(
            min=0.0, metavar="SECONDS", help="Leave out what was recorded later.", show_default="the end"
        ),
    ] = None,
    tolerance_us: Annotated[
        float, typer.Option(min=0.0, help="So far may a frame be from its recorded instant.")
    ] = 0.0,
    without: Annotated[
        list[str] | None,
        typer.Option(metavar="SERVICE", help=f"Do not compare: {', '.join(SERVICE_NAMES)}; may be repeated."),
    ] = None,
    plant: Annotated[
        Path | None,
        typer.Option(metavar="FMU", help="Another plant below the drives.", show_default=False),
    ] = None,
) -> None:
    """Play a recording again in virtual time, and show the first packet that differs from it.

    Exit status 0 where none differs, 1 where one does, 2 for a recording that cannot be used.
    """
    machine = find_robot(robot)
    for name in without or ():
        if name not in SERVICE_NAMES:
            raise refusal(f"--without {name}: no such service; there are: {', '.join(SERVICE_NAMES)}")
    with one_message(ValueError, OverflowError):
        limit = None if until is None else from_seconds(until)
    with one_message(RecordingFileError, PlanError, PlantError, ServoError):
        order = Order(
            machine,
            recording,
            operator,
            into,
            channel,
            limit,
            round(tolerance_us * MICROSECOND),
            frozenset(without or ()),
            plant,
        )
        with progress_bar() as bar:
            task = bar.add_task(recording.name, total=None)
            outcome = play(order, lambda now, end: bar.update(task, completed=now, total=end))
    if outcome.difference is not None:
        typer.echo(outcome.difference)
        raise typer.Exit(FAILED)
    typer.echo(
        f"no difference: {outcome.compared} packets of the {outcome.into} are as recorded,"
        f" {outcome.played} others were played, in {to_seconds(outcome.until):.3f} s"
    )


def attach(program: typer.Typer) -> None:
    """Add the command to the program."""
    program.command(epilog=EXAMPLES)(replay)
