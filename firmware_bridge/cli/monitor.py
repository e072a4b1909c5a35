"""`monitor`: a CAN bus in words, live or from a recording, without a frame of one's own."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.options import (
    ChannelOption,
    DurationOption,
    FirmwareOption,
    InterfaceOption,
    RobotBitRateOption,
)

EXAMPLES: Final = """Examples:

`firmware-bridge monitor -i socketcan -c can0`

`firmware-bridge monitor -i socketcan -c can0 --robot rars` names the drives, and knows their PDOs at once.

`firmware-bridge monitor --log out/rars-circles/can.log`

`firmware-bridge monitor --log out/rome-circle/serial.log --robot rome --protocol mw` says line by line what a
board was told and has answered."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MonitorOptions:
    """Show a CAN bus in words: who is there, PDOs, statuswords, emergencies, rates, load, the last error.

    It sends nothing. On a terminal the picture is drawn anew; elsewhere each change is a line, and the
    picture comes at the end. A PDO is read by the robot file's mapping, or by one that was seen to be
    written; the bytes of others are shown as they are. Ends on Ctrl-C. A recording of serial lines or of
    cameras is said line by line, by the protocols of --robot.
    """

    interface: InterfaceOption = None
    channel: ChannelOption = None
    bit_rate: RobotBitRateOption = None
    robot: Annotated[
        str | None,
        typer.Option(
            metavar="ROBOT",
            help="Whose drives are on the bus: a robot that `robots` lists, or the path of a robot file.",
            show_default=False,
            autocompletion=completing("firmware_bridge.cli.robot_argument:names"),
        ),
    ] = None
    link: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Of a robot with several CAN buses: which one it is.",
            show_default="the only one",
        ),
    ] = None
    log: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="In place of a bus: a recording in candump's format, or serial.log or capture.log, may be "
            ".gz or .xz; -c chooses one of several buses or lines in it.",
            show_default=False,
        ),
    ] = None
    protocol: FirmwareOption = None
    duration: DurationOption = None


monitor: Final = command(EXAMPLES, work="firmware_bridge.cli.monitor_work:monitor")(MonitorOptions)
