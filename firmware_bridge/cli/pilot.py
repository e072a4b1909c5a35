"""`pilot`: a ground station that drives, over the operator's link."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.options import DurationOption, MaxDelayOption, RobotArgument

EXAMPLES: Final = """Examples:

`firmware-bridge pilot rars --joystick`

`firmware-bridge pilot rars --joystick --device /dev/input/js1 --controls gamepad`

`firmware-bridge pilot rars --keyboard --telemetry cycle`

`firmware-bridge pilot rars --path circle --size 2 --speed 0.3 --predictor --arm`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PilotOptions:
    """Drive a robot over its operator's link: by hand, or along a path.

    Its bridge calls this machine, as `drive` does by default; what the link brings is shown.

    Ends on Ctrl-C: what moves is let go, and the robot is disarmed. Where the joystick is lost nothing more
    is said, and the bridge stops the robot by its silence.
    """

    robot: RobotArgument
    mavlink: Annotated[
        str, typer.Option(metavar="LINK", help="Where the bridge is: udpin:HOST:PORT or udpout:HOST:PORT.")
    ] = "udpin:127.0.0.1:14550"
    joystick: Annotated[
        bool,
        typer.Option(
            "--joystick",
            help="Drive with a helm and two pedals; buttons: reverse, arm, emergency stop, the robot's "
            "switches.",
        ),
    ] = False
    device: Annotated[str, typer.Option(metavar="DEVICE", help="The joystick.")] = "/dev/input/js0"
    controls: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="What it is: pedals, with a helm, or gamepad. One that says that it is a gamepad must be "
            "called one.",
            show_default="pedals",
        ),
    ] = None
    keyboard: Annotated[
        bool,
        typer.Option(
            "--keyboard", help="Drive with this terminal's keys, which must be kept down; Enter stops."
        ),
    ] = False
    path: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FILE",
            help="Follow a path by pure pursuit: line, circle, eight, or a .csv file of points (x,y).",
        ),
    ] = None
    size: Annotated[float, typer.Option(min=0.1, metavar="M", help="The line's length, or the radius.")] = 5.0
    speed: Annotated[float, typer.Option(min=0.01, metavar="M_S", help="Along the path, or by keys.")] = 0.3
    look_ahead: Annotated[
        float, typer.Option("--look-ahead", min=0.05, metavar="M", help="To the goal on the path.")
    ] = 0.5
    predictor: Annotated[
        bool, typer.Option("--predictor", help="Drive by where the robot will be when the word reaches it.")
    ] = False
    arm: Annotated[
        bool,
        typer.Option("--arm", help="Arm the robot when it is heard. IT MOVES where a path is given."),
    ] = False
    telemetry: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="What the robot is asked for: usual, or cycle, all 20 times a second.",
        ),
    ] = "usual"
    key: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Sign what is said with the key in this file, as `drive --key`, and believe nothing else.",
            show_default="unsigned",
        ),
    ] = None
    max_delay: MaxDelayOption = None
    duration: DurationOption = None


pilot: Final = command(EXAMPLES, work="firmware_bridge.cli.pilot_work:pilot")(PilotOptions)
