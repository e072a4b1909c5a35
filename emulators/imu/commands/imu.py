"""An IMU without a robot at the command line: `emulate imu`."""

from dataclasses import dataclass
from math import radians
from typing import Annotated, Final

import typer

from emulators.cli.emulation import Emulation, emulating
from emulators.cli.options import LineLinkOption, LineOption
from firmware_bridge.cli.options import DurationOption
from firmware_bridge.node import SERIAL

EXAMPLES: Final = """Examples:

`firmware-bridge emulate imu --serial-link imu.tty`

`firmware-bridge emulate imu --pitch 10 --roll -5 --seed 3`

`firmware-bridge emulate imu --serial /dev/ttyUSB0 --baud 230400`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ImuOptions:
    """Send the frames of an IMU on a serial line, in real time.

    For developers of a reader without a sensor at hand: a body at rest, 100 frames a second, with the noise
    and the biases of a cheap part. The protocol is in docs/imu.md. Ends on Ctrl-C.
    """

    serial: LineOption = "pty"
    serial_link: LineLinkOption = None
    baud: Annotated[
        int, typer.Option(min=38_400, max=1_000_000, metavar="BAUD", help="Bit rate of the line, bit/s.")
    ] = 115_200
    pitch: Annotated[
        float, typer.Option(min=-90.0, max=90.0, metavar="DEG", help="Pitch of the body, nose up positive.")
    ] = 0.0
    roll: Annotated[
        float,
        typer.Option(min=-180.0, max=180.0, metavar="DEG", help="Roll of the body, left side up positive."),
    ] = 0.0
    seed: Annotated[int, typer.Option(min=0, help="Seed of all random numbers.")] = 0
    duration: DurationOption = None


def start(given: ImuOptions) -> Emulation:
    """Make the sensor of `emulate imu`; an error ends the program with a message."""
    import numpy as np

    from emulators.imu.device import Imu
    from emulators.imu.part import MemsPart
    from emulators.imu.truth import LEVEL, felt, posed
    from firmware_bridge.cli.links import Openers, open_serial

    pose = posed(
        {"x": 0.0, "y": 0.0, "heading": 0.0, "pitch": radians(given.pitch), "roll": radians(given.roll)}
    )
    stands = felt([pose, pose, pose], 1.0)
    imu = Imu(lambda _: stands, MemsPart(np.random.default_rng(given.seed), LEVEL))

    def opened() -> tuple[Openers, str]:
        # At once: the name of a pseudo-terminal is known only then.
        line = open_serial(given.serial, given.baud, given.serial_link)
        return {SERIAL: lambda: line}, line.name

    return Emulation(
        node=imu,
        opened=opened,
        text=lambda where: (
            f"IMU at {given.baud} Bd on {where}: pitch {given.pitch:g}, roll {given.roll:g} deg"
        ),
    )


emulate: Final = emulating(ImuOptions, EXAMPLES, start)
