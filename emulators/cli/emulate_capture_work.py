"""Streams what an emulated motion capture system sees over UDP, in real time."""

import re
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from emulators.cli.emulate_capture import CaptureOptions
from emulators.motion_capture.bodies import Body, Circling
from emulators.motion_capture.exposure import Cameras, Hidden, Swapped
from emulators.motion_capture.system import COMMAND, DATA, MotionCapture, Timing
from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.cli.options import until
from firmware_bridge.cli.real_time import carry
from firmware_bridge.shell.clock import LivedClock
from firmware_bridge.shell.ports import PortError, UdpPort
from firmware_bridge.units import Nanoseconds, from_seconds
from firmware_bridge.wire.natnet.layout import NatNetError, Version

_MILLI: Final = 1e-3
_ASIDE: Final = (0.3, 0.0, 0.0)
_SPAN: Final = re.compile(r"(?P<name>.+)@(?P<begin>\d+(\.\d+)?)-(?P<end>\d+(\.\d+)?)")


def emulate(given: CaptureOptions) -> None:
    """Do what `emulate capture` says; what is wrong ends the program with a message."""
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
    carry(
        system,
        {COMMAND: lambda: command, DATA: lambda: data},
        until(given.duration),
        f"NatNet {system.server.version} at {given.host}:{command.port}, frames from port {data.port}:"
        f" {', '.join(f'{body.id} {body.name}' for body in bodies)}",
        clock=LivedClock(),
    )


def version_of(text: str) -> Version:
    """Read a version; what is none ends the program."""
    major, _, minor = text.partition(".")
    if not (major.isdecimal() and minor.isdecimal()):
        raise refusal(f"--natnet {text}: say a version as 3.1")
    return Version(int(major), int(minor))


def bodies_named(names: Sequence[str]) -> list[Body]:
    """Return bodies on circles, each a metre wider than the last; a name given twice ends the program."""
    if len(set(names)) != len(names):
        raise refusal(f"--body: {', '.join(names)}: each needs a name of its own")
    return [Body(number, name, Circling(float(number))) for number, name in enumerate(names, 1)]


def _spans(
    option: str, texts: Sequence[str] | None, bodies: Sequence[Body]
) -> Iterator[tuple[int, Nanoseconds, Nanoseconds]]:
    """Read NAME@FROM-TO; what is none ends the program."""
    numbers = {body.name: body.id for body in bodies}
    for text in texts or ():
        match = _SPAN.fullmatch(text)
        if match is None or match["name"] not in numbers:
            raise refusal(f"{option} {text}: say NAME@FROM-TO with one of {', '.join(numbers)}, as robot@5-7")
        yield numbers[match["name"]], from_seconds(float(match["begin"])), from_seconds(float(match["end"]))
