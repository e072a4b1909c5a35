"""Arguments and options that more than one command takes, so that they are spelt and explained once."""

from pathlib import Path
from typing import Annotated, Any

import typer

from firmware_bridge.cli.commands import completing
from firmware_bridge.cli.console import one_message
from firmware_bridge.units import NEVER, Nanoseconds, from_seconds

RobotArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        help="A robot that `robots` lists, or the path of a robot file (.toml).",
        autocompletion=completing("firmware_bridge.cli.robot_argument:names"),
    ),
]
InterfaceOption = Annotated[
    str | None,
    typer.Option(
        "--interface",
        "-i",
        help="python-can's interface: socketcan, slcan, pcan, loopback_multicast ... Default: python-can's "
        "own configuration file.",
        show_default=False,
    ),
]
ChannelOption = Annotated[
    str | None,
    typer.Option(
        "--channel", "-c", help="Channel of the bus: can0, vcan0, /dev/ttyACM0 ...", show_default=False
    ),
]


def _bit_rate(default: str) -> Any:
    return typer.Option(
        "--bitrate", "-b", min=10_000, max=1_000_000, help="Bit rate, in bit/s.", show_default=default
    )


RobotBitRateOption = Annotated[int | None, _bit_rate("the robot's")]
BitRateOption = Annotated[int | None, _bit_rate("1000000")]
LinkOption = Annotated[
    list[str] | None,
    typer.Option(
        "--link",
        metavar="NAME=PLACE|KEY=NUMBER,...",
        help="Place of one of several links: INTERFACE:CHANNEL, or serial:DEVICE. Or, for training, an "
        "impairment of the operator's link, including the emergency stop: "
        "delay=0.5,jitter=0.1,up.loss=0.02. May be repeated.",
        show_default=False,
    ),
]
ZeroOption = Annotated[
    list[str] | None,
    typer.Option(
        "--zero",
        metavar="AXIS=VALUE",
        help="Position of an axis when the bridge starts, read off the robot; may be repeated. A wrong "
        "name lists the valid names and their units. Without it the station in control confirms the "
        "position before the robot is armed.",
        show_default=False,
    ),
]
HomeOption = Annotated[
    list[str] | None,
    typer.Option(
        "--home",
        metavar="AXIS",
        help="Home an axis once the drives are ready, by its robot file; may be repeated, in this order. "
        "IT MOVES: an operator must have sent commands by then, and may stop it.",
        show_default=False,
    ),
]


FirmwareOption = Annotated[
    str | None,
    typer.Option(
        "--protocol",
        metavar="NAME",
        help="Firmware of the board of a motor shield: mw, ros-arduino-bridge, arduinoio or firmata.",
        show_default="the robot's",
    ),
]
EncodersOption = Annotated[
    int | None,
    typer.Option(
        min=0,
        max=4,
        metavar="N",
        help="Number of encoders that the board of a motor shield reads; more than the published firmware "
        "reads needs a modified firmware.",
        show_default="the firmware's",
    ),
]
PathOption = Annotated[
    Path | None,
    typer.Option(
        "--path",
        metavar="FILE.csv",
        help="CSV file for the robot's path follower `points`, one point a row: t,x,y or t,x,y,psi (s, m, "
        "rad), or x,y with --path-speed.",
        show_default="the robot file's",
    ),
]
PathSpeedOption = Annotated[
    float | None,
    typer.Option(
        "--path-speed",
        min=0.001,
        max=10.0,
        metavar="M/S",
        help="Speed along a path whose points have no times.",
        show_default=False,
    ),
]
_SLOW = (
    "How slow the operator's link is: KEY=NUMBER, ...; delay is there and back, each other key each way; "
    "up.KEY or down.KEY is of one way. Keys: delay, jitter, queue (s), loss, duplicate (shares), burst, "
    "bandwidth (bit/s)."
)
SlowLinkOption = Annotated[
    str | None,
    typer.Option("--link", metavar="KEY=NUMBER,...", help=_SLOW, show_default="the mission's"),
]
MaxDelayOption = Annotated[
    float | None,
    typer.Option(
        "--max-delay",
        min=0.05,
        metavar="SECONDS",
        help="Maximum age of commands agreed on for this session, up to the robot file's ceiling. The "
        "larger it is, the slower the robot moves.",
        show_default="operator.max_age_ms",
    ),
]
DurationOption = Annotated[
    float | None,
    typer.Option(
        min=0.0, metavar="SECONDS", help="End in good order after this time.", show_default="until Ctrl-C"
    ),
]


def until(duration_s: float | None) -> Nanoseconds:
    """Return the instant at which a run of this duration ends."""
    with one_message(ValueError, OverflowError):
        return NEVER if duration_s is None else from_seconds(duration_s)
