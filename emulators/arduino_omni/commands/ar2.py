"""The arm AR2 at the command line: `emulate ar2`."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.options import DurationOption, until
from firmware_bridge.cli.recorded import RecordOption, recording
from firmware_bridge.node import SERIAL
from firmware_bridge.recording import device_side
from firmware_bridge.runtime.black_box import SERIAL_LOG

if TYPE_CHECKING:
    from emulators.arduino_omni.ar2.board import Ar2Board


AR2: Final = "ar2-2.0"
"""Name of the board's protocol in a log, as `monitor` reads it; 1.5 speaks a part of it."""
EXAMPLES: Final = """Examples:

`firmware-bridge emulate ar2 --serial pty --serial-link arm.tty`

`firmware-bridge emulate ar2 --firmware 1.5 --reset-on-open`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ar2Options:
    """Put the board of an AR2 arm on a serial line, in real time, with the arm on its drivers.

    For developers of a client without an arm at hand. The arm is at its rest position, as after a
    calibration, is on from the beginning, and receives nothing for the boot loader's 1.1 s. Joints carry
    their weight, and lose steps where a motor is too weak for it at its speed; nothing on the line reports
    it. Ends on Ctrl-C, and then prints the joints' true positions.
    """

    firmware: Annotated[str, typer.Option(help="Version of its sketch: 2.0 or 1.5.")] = "2.0"
    serial: Annotated[
        str,
        typer.Option(
            metavar="pty|DEVICE", help="On a pseudo-terminal of this machine, or on a serial device."
        ),
    ] = "pty"
    serial_link: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="With --serial pty: a symbolic link to it, so that its name is always the same.",
            show_default=False,
        ),
    ] = None
    reset_on_open: Annotated[
        bool,
        typer.Option(
            "--reset-on-open",
            help="With --serial pty, on Linux: a client that opens it resets the board, as on a real one.",
        ),
    ] = False
    record: RecordOption = None
    duration: DurationOption = None


def run(given: Ar2Options) -> None:
    """Run the command `emulate ar2`; an error ends the program with a message."""
    from emulators.arduino_omni.ar2.board import Ar2Board
    from emulators.arduino_omni.ar2.firmwares import FIRMWARES
    from emulators.arduino_omni.commands.reported import keeping_reported
    from emulators.arduino_omni.mega.mega import SketchError
    from firmware_bridge.cli.links import open_serial
    from firmware_bridge.cli.real_time import carry
    from firmware_bridge.runtime.clock import LivedClock
    from firmware_bridge.runtime.ports import PortError
    from firmware_bridge.runtime.ports.pseudo_terminal import WORD

    firmware = FIRMWARES.get(given.firmware)
    if firmware is None:
        raise refusal(f"--firmware {given.firmware}: there is none; there are: {', '.join(FIRMWARES)}")
    if given.reset_on_open and given.serial != WORD:
        raise refusal(
            f"--reset-on-open: on {given.serial} the device itself decides; only --serial pty needs it"
        )
    board = Ar2Board(firmware)
    keeping_reported(board.mega)
    called = {SERIAL: device_side("arm", AR2)}
    with recording(given.record, {SERIAL: SERIAL_LOG}, called=called) as (around, _):
        with one_message(PortError):
            line = open_serial(
                given.serial, firmware.baud, given.serial_link, reports_dtr=given.reset_on_open
            )
        carry(
            around(board),
            {SERIAL: lambda: line},
            until(given.duration),
            f"{firmware.title} on {line.name}: {_places(board)}",
            SketchError,
            clock=LivedClock(),
        )
    say(f"the arm is at {_places(board)}; lost steps: {', '.join(map(str, board.joints.lost))}")


def _places(board: "Ar2Board") -> str:
    """Return where the joints are, in degrees."""
    from emulators.arduino_omni.ar2.axes import JOINTS

    angles = zip(JOINTS, board.joints.angles, strict=True)
    return ", ".join(f"{axis.name} {angle:.2f}" for axis, angle in angles)


emulate: Final = command(EXAMPLES, work=run)(Ar2Options)
