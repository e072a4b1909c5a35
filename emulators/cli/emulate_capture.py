"""A motion capture system at the command line: `emulate capture`."""

from dataclasses import dataclass
from typing import Annotated, Final

import typer

from emulators.motion_capture.exposure import Lost, Up
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.options import DurationOption
from firmware_bridge.wire.natnet.messages import COMMAND_PORT, DATA_PORT

EXAMPLES: Final = """Examples:

`firmware-bridge emulate capture`

`firmware-bridge emulate capture --natnet 4.1 --body robot --body box --lost nan`

`firmware-bridge emulate capture --up z --hide robot@5-7 --swap robot@10-10.2`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CaptureOptions:
    """Stream what an OptiTrack system would see as NatNet over UDP unicast, in real time.

    For whoever writes a client and has no cameras at hand. A client connects at the command port, and is sent
    a frame at every exposure until it has not been heard for 10 s. Bodies go round circles about the room's
    middle with 0.5 m/s, the first at 1 m, the second at 2 m, and so on; their numbers are 1, 2 ... Ends on
    Ctrl-C.
    """

    natnet: Annotated[
        str,
        typer.Option(metavar="VERSION", help="The version that it speaks: 2.9, 2.10, 3.0, 3.1, 4.0 to 4.4."),
    ] = "3.1"
    host: Annotated[str, typer.Option(help="The address of this machine that clients connect to.")] = (
        "127.0.0.1"
    )
    command_port: Annotated[
        int, typer.Option(min=0, max=0xFFFF, help="Where clients connect; 0 for any that is free.")
    ] = COMMAND_PORT
    data_port: Annotated[
        int, typer.Option(min=0, max=0xFFFF, help="Where frames come from; 0 for any that is free.")
    ] = DATA_PORT
    body: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="A rigid body; may be given more than once.", show_default="robot"),
    ] = None
    rate: Annotated[int, typer.Option(min=20, max=1000, metavar="HZ", help="Frames a second.")] = 240
    noise_mm: Annotated[
        float, typer.Option(min=0.0, max=100.0, help="The standard deviation of a position along each axis.")
    ] = 0.2
    up: Annotated[Up, typer.Option(help="Which axis of the stream points upwards.")] = Up.Y
    lost: Annotated[Lost, typer.Option(help="What is sent of a body that is hidden.")] = Lost.FREEZE
    hide: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME@FROM-TO",
            help="Hide a body between these seconds; may be repeated.",
            show_default=False,
        ),
    ] = None
    swap: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME@FROM-TO",
            help="Take a body's markers for others: it is seen 0.3 m aside, the other way round, and counts "
            "as tracked; may be repeated.",
            show_default=False,
        ),
    ] = None
    seed: Annotated[int, typer.Option(min=0, help="Of all that is left to chance.")] = 0
    duration: DurationOption = None


emulate: Final = command(EXAMPLES, work="emulators.cli.emulate_capture_work:emulate")(CaptureOptions)
