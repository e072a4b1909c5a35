"""`new`: a package for a robot of one's own, at the command line."""

from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command, completing

EXAMPLES: Final = """Example:

`firmware-bridge new mouse --kind differential --nodes 1,2 --wheel-radius 0.08 --track 0.35`

`pip install -e mouse`

`firmware-bridge bench mouse`"""

TWO: Final = "LEFT,RIGHT"


@command(EXAMPLES, work="emulators.cli.new_work:new")
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The robot's, its package's and its kind's.")],
    *,
    kind: Annotated[
        str,
        typer.Option(
            "--kind",
            help="How it moves: differential.",
            autocompletion=completing("emulators.starter.package:kinds"),
        ),
    ] = "differential",
    nodes: Annotated[str, typer.Option("--nodes", metavar=TWO, help="CANopen nodes of its drives.")] = "1,2",
    wheel_radius: Annotated[float, typer.Option("--wheel-radius", metavar="M", help="Of the driven wheels.")],
    track: Annotated[float, typer.Option("--track", metavar="M", help="From driven wheel to driven wheel.")],
    axes: Annotated[str, typer.Option("--axes", metavar=TWO, help="Names of its axes.")] = "left,right",
    device: Annotated[str, typer.Option("--device", help="The type of its drives: EPOS2 ...")] = "70/10",
    motor: Annotated[
        str,
        typer.Option(
            "--motor",
            metavar="NAME|FILE",
            help="A motor that is known, or a file (.toml) with its data.",
            autocompletion=completing("emulators.starter.motors:names"),
        ),
    ] = "RE40",
    gear: Annotated[
        float, typer.Option("--gear", metavar="RATIO", help="Turns of the motor for one of the wheel.")
    ] = 43.0,
    encoder_lines: Annotated[
        int, typer.Option("--encoder-lines", help="Of the encoder, for one turn of the motor.")
    ] = 500,
    mass: Annotated[float, typer.Option("--mass", metavar="KG", help="Of all of it, loaded.")] = 25.0,
    voltage: Annotated[float, typer.Option("--voltage", metavar="V", help="Of its battery.")] = 24.0,
    speed: Annotated[float, typer.Option("--speed", metavar="M/S", help="Its speed limit.")] = 0.6,
    acceleration: Annotated[
        float, typer.Option("--acceleration", metavar="M/S2", help="What it stands, load and all.")
    ] = 0.5,
    turn_rate: Annotated[
        float, typer.Option("--turn-rate", metavar="RAD/S", help="Its turn rate's limit.")
    ] = 1.2,
    folder: Annotated[
        Path | None,
        typer.Option("--dir", metavar="DIR", help="Where the package goes.", show_default="NAME"),
    ] = None,
) -> None:
    """Write a package for a robot of your own: robot file, rules, plant, missions; it drives at once.

    The gains are worked out from the motor's data and the mass. Look at each number marked ASSUME before the
    real robot moves.
    """
