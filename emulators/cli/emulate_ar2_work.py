"""Puts the emulated board of an AR2 arm on a real serial line, in real time."""

from emulators.arduino_omni.ar2.axes import JOINTS
from emulators.arduino_omni.ar2.board import Ar2Board
from emulators.arduino_omni.ar2.firmwares import FIRMWARES
from emulators.arduino_omni.mega.mega import SketchError
from emulators.cli.emulate_ar2 import Ar2Options
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.links import open_serial
from firmware_bridge.cli.options import until
from firmware_bridge.cli.real_time import carry
from firmware_bridge.cli.recorded import recording
from firmware_bridge.node import SERIAL
from firmware_bridge.shell.black_box import SERIAL_LOG
from firmware_bridge.shell.clock import LivedClock
from firmware_bridge.shell.ports import PortError
from firmware_bridge.shell.ports.pseudo_terminal import WORD


def emulate(given: Ar2Options) -> None:
    """Do what `emulate ar2` says; what is wrong ends the program with a message."""
    firmware = FIRMWARES.get(given.firmware)
    if firmware is None:
        raise refusal(f"--firmware {given.firmware}: there is none; there are: {', '.join(FIRMWARES)}")
    if given.reset_on_open and given.serial != WORD:
        raise refusal(
            f"--reset-on-open: on {given.serial} the device itself decides; only --serial pty needs it"
        )
    board = Ar2Board(firmware)
    with recording(given.record, {SERIAL: SERIAL_LOG}) as (around, _):
        with one_message(PortError):
            line = open_serial(given.serial, firmware.baud, given.serial_link, tells_dtr=given.reset_on_open)
        carry(
            around(board),
            {SERIAL: lambda: line},
            until(given.duration),
            f"{firmware.title} on {line.name}: {_places(board)}",
            SketchError,
            clock=LivedClock(),
        )
    say(f"the arm is at {_places(board)}; lost steps: {', '.join(map(str, board.joints.lost))}")


def _places(board: Ar2Board) -> str:
    """Return where the joints are, in degrees."""
    angles = zip(JOINTS, board.joints.angles, strict=True)
    return ", ".join(f"{axis.name} {angle:.2f}" for axis, angle in angles)
