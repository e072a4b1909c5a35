"""`drive`: the bridge on a real bus."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.options import (
    ChannelOption,
    DurationOption,
    EncodersOption,
    HomeOption,
    InterfaceOption,
    LinkOption,
    MaxDelayOption,
    PathOption,
    PathSpeedOption,
    RobotArgument,
    RobotBitRateOption,
    Spoken,
    ZeroOption,
)
from firmware_bridge.cli.recorded import RecordOption

EXAMPLES: Final = """Examples:

`firmware-bridge drive rars -i socketcan -c can0`

`firmware-bridge drive rars --serial /dev/ttyUSB0` drives over the first drive's USB or RS232 port.

`firmware-bridge drive rome --serial /dev/ttyACM0` drives a board with a motor shield.

`firmware-bridge drive rome --protocol mw --encoders 3 --accept-no-watchdog --serial /dev/ttyACM0`

`firmware-bridge drive rars -i slcan -c /dev/ttyACM0 --mavlink udpout:192.168.1.10:14550 --key rars.key`

`firmware-bridge drive rars -i socketcan -c can0 --link delay=0.5,jitter=0.1` for training

`firmware-bridge drive rars -i socketcan -c can0 --mavlink udpin::14550 --key rars.key --allow 10.0.0.0/24`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveOptions:
    """Run the bridge on a real CAN bus or serial line: find the drives, set them up, and obey the operator.

    Ends on Ctrl-C, Ctrl-Z, or when its terminal is closed: the robot is brought to rest first, then its
    drives are disabled, and a second Ctrl-C does not cut that short. A serial port that is unplugged is
    waited for; the robot must be armed again then.
    """

    robot: RobotArgument
    interface: InterfaceOption = None
    channel: ChannelOption = None
    bit_rate: RobotBitRateOption = None
    mavlink: Annotated[
        str,
        typer.Option(
            metavar="LINK",
            help="The operator's link: udpout:HOST:PORT calls a station, by default one that listens on this "
            "machine; udpin:HOST:PORT waits for one. One that reaches beyond this machine needs --key or "
            "--open.",
        ),
    ] = "udpout:127.0.0.1:14550"
    bandwidth: Annotated[
        int | None,
        typer.Option(
            min=4_800,
            metavar="BIT_S",
            help="What the operator's link carries, as a telemetry radio's serial line, for instance 57600: "
            "telemetry takes at most half of it.",
            show_default="the robot's",
        ),
    ] = None
    key: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Obey only what is signed with this key (MAVLink 2), and sign what is said: 64 hexadecimal "
            "digits, or the phrase that the station was given. An emergency stop is obeyed of anybody.",
            show_default=False,
        ),
    ] = None
    allow: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ADDRESS",
            help="Listen only to this address, or network as 192.168.1.0/24; may be repeated.",
            show_default="all",
        ),
    ] = None
    openly: Annotated[
        bool, typer.Option("--open", help="Without a key: let whoever can reach the link drive the robot.")
    ] = False
    serial: Annotated[
        str | None,
        typer.Option(
            "--serial",
            metavar="DEVICE",
            help="Instead of CAN: the serial port of one drive, which passes commands on to the others.",
            show_default=False,
        ),
    ] = None
    baud: Annotated[
        int | None,
        typer.Option(min=9_600, max=1_000_000, help="Of the serial port.", show_default="the robot's"),
    ] = None
    protocol: Annotated[
        Spoken | None,
        typer.Option(
            help="What the serial port speaks: v1 as on RS232, v2 as on USB; of a board with a motor shield "
            "what it was flashed with.",
            show_default="the robot's",
        ),
    ] = None
    encoders: EncodersOption = None
    accept_no_watchdog: Annotated[
        bool,
        typer.Option(
            "--accept-no-watchdog",
            help="Drive a board whose firmware does not stop its motors when the bridge ends or the line is "
            "cut: keep the switch of their supply within reach.",
        ),
    ] = False
    path: PathOption = None
    path_speed: PathSpeedOption = None
    link: LinkOption = None
    max_delay: MaxDelayOption = None
    mode: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Begin in this mode after a failed actuator: its device is left alone. A wrong name is "
            "answered with those that there are.",
            show_default="the whole robot",
        ),
    ] = None
    zero: ZeroOption = None
    home: HomeOption = None
    state: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Where the places of the axes are kept for the next run, which tells them as an offer.",
            show_default="~/.local/state/firmware-bridge/ROBOT.json",
        ),
    ] = None
    record: RecordOption = None
    duration: DurationOption = None


drive: Final = command(EXAMPLES, work="firmware_bridge.cli.drive_work:drive")(DriveOptions)
