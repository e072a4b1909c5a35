"""A motion capture system at the command line: `emulate capture`."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import typer

from emulators.cli.emulation import Emulation, emulating
from emulators.motion_capture.bodies import Circling, TrackedBody
from emulators.motion_capture.exposure import Cameras, Hidden, Lost, Swapped, Up
from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.cli.options import DurationOption
from firmware_bridge.families.motion_capture.wire.layout import NatNetError, Version
from firmware_bridge.families.motion_capture.wire.messages import COMMAND_PORT, DATA_PORT
from firmware_bridge.units import Nanoseconds, from_seconds

EXAMPLES: Final = """Examples:

`firmware-bridge emulate capture`

`firmware-bridge emulate capture --natnet 4.1 --body robot --body box --lost nan`

`firmware-bridge emulate capture --up z --hide robot@5-7 --swap robot@10-10.2`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CaptureOptions:
    """Stream the frames of an OptiTrack system as NatNet over UDP unicast, in real time.

    For developers of a client without cameras at hand. A client connects at the command port, and receives a
    frame at every exposure until it has sent nothing for 10 s. Bodies go round circles about the room's
    center with 0.5 m/s, the first at 1 m, the second at 2 m, and so on; their numbers are 1, 2 ... Ends on
    Ctrl-C.
    """

    natnet: Annotated[
        str,
        typer.Option(metavar="VERSION", help="NatNet version: 2.9, 2.10, 3.0, 3.1, 4.0 to 4.4."),
    ] = "3.1"
    host: Annotated[str, typer.Option(help="Address of this machine for clients.")] = "127.0.0.1"
    command_port: Annotated[
        int, typer.Option(min=0, max=0xFFFF, help="Command port; 0 for any free port.")
    ] = COMMAND_PORT
    data_port: Annotated[int, typer.Option(min=0, max=0xFFFF, help="Data port; 0 for any free port.")] = (
        DATA_PORT
    )
    body: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="A rigid body; may be given more than once.", show_default="robot"),
    ] = None
    rate: Annotated[
        int, typer.Option(min=20, max=1000, metavar="HZ", help="Frame rate, in frames a second.")
    ] = 240
    noise_mm: Annotated[
        float, typer.Option(min=0.0, max=100.0, help="Standard deviation of a position along each axis.")
    ] = 0.2
    up: Annotated[Up, typer.Option(help="Axis of the stream that points upwards.")] = Up.Y
    lost: Annotated[Lost, typer.Option(help="Data of a hidden body.")] = Lost.FREEZE
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
            help="Confuse a body's markers: it appears 0.3 m aside, turned by 180 degrees, and counts as "
            "tracked; may be repeated.",
            show_default=False,
        ),
    ] = None
    seed: Annotated[int, typer.Option(min=0, help="Seed of all random numbers.")] = 0
    duration: DurationOption = None


_MILLI: Final = 1e-3

_ASIDE: Final = (0.3, 0.0, 0.0)

_SPAN: Final = re.compile(r"(?P<name>.+)@(?P<begin>\d+(\.\d+)?)-(?P<end>\d+(\.\d+)?)")


def start(given: CaptureOptions) -> Emulation:
    """Make the system of `emulate motion_capture`; an error ends the program with a message."""
    import numpy as np

    from emulators.motion_capture.system import COMMAND, DATA, MotionCapture, Timing
    from firmware_bridge.runtime.ports import PortError, UdpPort

    bodies = bodies_named(given.body or ["robot"])
    cameras = Cameras(noise_m=given.noise_mm * _MILLI, lost=given.lost, up=given.up)
    with one_message(PortError):
        command = UdpPort(f"udpin:{given.host}:{given.command_port}")
        data = UdpPort(f"udpin:{given.host}:{given.data_port}")
    with one_message(NatNetError):
        system = MotionCapture(
            bodies,
            np.random.default_rng(given.seed),
            version=version_of(given.natnet),
            cameras=cameras,
            timing=Timing(rate_hz=given.rate),
            data_port=data.port,
        )
    for body, begin, end in _spans("--hide", given.hide, bodies):
        system.hide(Hidden(body, begin, end))
    for body, begin, end in _spans("--swap", given.swap, bodies):
        system.hide(Swapped(body, begin, end, aside=_ASIDE))
    return Emulation(
        node=system,
        opened=lambda: ({COMMAND: lambda: command, DATA: lambda: data}, f"{given.host}:{command.port}"),
        text=lambda where: (
            f"NatNet {system.server.version} at {where}, frames from port {data.port}: "
            f"{', '.join(f'{body.id} {body.name}' for body in bodies)}"
        ),
    )


def version_of(text: str) -> Version:
    """Read a version; what is none ends the program."""
    major, _, minor = text.partition(".")
    if not (major.isdecimal() and minor.isdecimal()):
        raise refusal(f"--natnet {text}: give a version as 3.1")
    return Version(int(major), int(minor))


def bodies_named(names: Sequence[str]) -> list[TrackedBody]:
    """Return bodies on circles, each a meter wider than the last; a name given twice ends the program."""
    if len(set(names)) != len(names):
        raise refusal(f"--body: {', '.join(names)}: each needs a name of its own")
    return [TrackedBody(number, name, Circling(float(number))) for number, name in enumerate(names, 1)]


def _spans(
    option: str, texts: Sequence[str] | None, bodies: Sequence[TrackedBody]
) -> Iterator[tuple[int, Nanoseconds, Nanoseconds]]:
    """Read NAME@FROM-TO; what is none ends the program."""
    numbers = {body.name: body.id for body in bodies}
    for text in texts or ():
        match = _SPAN.fullmatch(text)
        if match is None or match["name"] not in numbers:
            raise refusal(
                f"{option} {text}: give NAME@FROM-TO with one of {', '.join(numbers)}, as robot@5-7"
            )
        yield numbers[match["name"]], from_seconds(float(match["begin"])), from_seconds(float(match["end"]))


emulate: Final = emulating(CaptureOptions, EXAMPLES, start)
