"""`replay`: a recording played again, and the first packet that differs, at the command line."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from emulators.replay.order import Into
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.options import HomeOption, MaxDelayOption, RobotArgument, ZeroOption
from firmware_bridge.dissector.canopen import SERVICE_NAMES

EXAMPLES: Final = """Examples:

`firmware-bridge replay out/rars-line/can.log rars` plays what the bridge has sent into emulated drives.

`firmware-bridge replay out/rars-line/can.log rars --operator out/rars-line/operator.tlog` plays what drives
and operator have sent into the bridge.

`firmware-bridge replay out/rars-line/operator.tlog rars` plays the operator's messages into the whole bench.

`firmware-bridge replay robot.log rars --without pdo --tolerance-us 5000` suits the bus of a real robot.

`--zero`, `--home` and `--max-delay` are those that `drive` was started with."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayOptions:
    """Play a recording again in virtual time, and show the first packet that differs from it.

    Exit status 0 where none differs, 1 where one does, 2 for a recording that cannot be used.
    """

    recording: Annotated[
        Path,
        typer.Argument(
            metavar="RECORDING",
            help="A CAN log as `candump -l` and `bench` write it, or a telemetry log (.tlog); also .gz, .xz.",
            show_default=False,
        ),
    ]
    robot: RobotArgument
    into: Annotated[
        Into | None,
        typer.Option(
            help="What the recording is played into: the drives, the bridge, or both of them on the bench.",
            show_default="drives for a CAN log, bridge with --operator, bench for a telemetry log",
        ),
    ] = None
    operator: Annotated[
        Path | None,
        typer.Option(metavar="TLOG", help="The operator's messages beside a CAN log.", show_default=False),
    ] = None
    channel: Annotated[
        str | None,
        typer.Option("--channel", "-c", help="Which bus, where a CAN log holds several.", show_default=False),
    ] = None
    until: Annotated[
        float | None,
        typer.Option(
            min=0.0, metavar="SECONDS", help="Leave out what was recorded later.", show_default="the end"
        ),
    ] = None
    tolerance_us: Annotated[
        float, typer.Option(min=0.0, help="So far may a frame be from its recorded instant.")
    ] = 0.0
    without: Annotated[
        list[str] | None,
        typer.Option(metavar="SERVICE", help=f"Do not compare: {', '.join(SERVICE_NAMES)}; may be repeated."),
    ] = None
    zero: ZeroOption = None
    home: HomeOption = None
    max_delay: MaxDelayOption = None
    plant: Annotated[
        Path | None,
        typer.Option(metavar="FMU", help="Another plant below the drives.", show_default=False),
    ] = None


replay: Final = command(EXAMPLES, work="emulators.cli.replay_work:replay")(ReplayOptions)
