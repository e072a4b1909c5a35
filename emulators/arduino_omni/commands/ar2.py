"""The arm AR2 at the command line: `emulate ar2`."""

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.arduino_omni.commands.line import LineOptions, checked, line_opened
from emulators.cli.emulation import Emulation, emulating
from emulators.cli.options import ControlOption, FaultOption
from firmware_bridge.cli.console import refusal
from firmware_bridge.cli.live_page import LiveOption
from firmware_bridge.cli.options import DurationOption
from firmware_bridge.cli.plot_option import PlotOption
from firmware_bridge.cli.recorded import RecordOption
from firmware_bridge.node import SERIAL
from firmware_bridge.recording import device_side
from firmware_bridge.runtime.black_box import SERIAL_LOG

if TYPE_CHECKING:
    from emulators.arduino_omni.ar2.board import Ar2Board
    from emulators.control.live import Live
    from emulators.gateway import Cluster


AR2: Final = "ar2-2.0"
"""Name of the board's protocol in a log, as `monitor` reads it; 1.5 speaks a part of it."""
EXAMPLES: Final = """Examples:

`firmware-bridge emulate ar2 --serial pty --serial-link arm.tty`

`firmware-bridge emulate ar2 --firmware 1.5 --reset-on-open`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ar2Options(LineOptions):
    """Put the board of an AR2 arm on a serial line, in real time, with the arm on its drivers.

    For developers of a client without an arm at hand. The arm is at its rest position, as after a
    calibration, is on from the beginning, and receives nothing for the boot loader's 1.1 s. Joints carry
    their weight, and lose steps where a motor is too weak for it at its speed; nothing on the line reports
    it. Ends on Ctrl-C, and then prints the joints' true positions.
    """

    firmware: Annotated[str, typer.Option(help="Version of its sketch: 2.0 or 1.5.")] = "2.0"
    record: RecordOption = None
    control: ControlOption = "unix"
    plotjuggler: PlotOption = None
    fault: FaultOption = None
    live: LiveOption = False
    duration: DurationOption = None


BOARD: Final = "board"
"""Name of the board's link."""


def start(given: Ar2Options) -> Emulation:
    """Make the board of `emulate ar2`; an error ends the program with a message."""
    from emulators.arduino_omni.ar2.board import Ar2Board
    from emulators.arduino_omni.ar2.firmwares import FIRMWARES
    from emulators.arduino_omni.commands.reported import keeping_reported
    from emulators.arduino_omni.mega.mega import SketchError
    from emulators.gateway import Cluster

    checked(given)
    firmware = FIRMWARES.get(given.firmware)
    if firmware is None:
        raise refusal(f"--firmware {given.firmware}: there is none; there are: {', '.join(FIRMWARES)}")
    board = Ar2Board(firmware)
    keeping_reported(board.mega)
    called = {SERIAL: device_side("arm", AR2)}
    cluster = Cluster({BOARD: board}, links={BOARD: {SERIAL: SERIAL}})
    return Emulation(
        node=cluster,
        opened=partial(line_opened, given, firmware.baud),
        text=lambda where: f"{firmware.title} on {where}: {_places(board)}",
        errors=(SketchError,),
        files={SERIAL: SERIAL_LOG},
        called=called,
        ended=lambda: f"the arm is at {_places(board)}; lost steps: {', '.join(map(str, board.joints.lost))}",
        live=lambda: _live(board, cluster, on_pty=given.on_pty),
    )


def _live(board: "Ar2Board", cluster: "Cluster", *, on_pty: bool) -> "Live":
    from emulators.arduino_omni.ar2.axes import JOINTS
    from emulators.arduino_omni.ar2.plant_joints import StepperMotor
    from emulators.control.alone import alone, stand_in
    from emulators.family import Station, Way

    numbers = {axis.name: number for number, axis in enumerate(JOINTS, start=1)}
    motors = [StepperMotor(name, board) for name in numbers]
    station = Station(board, BOARD, {SERIAL: Way.LINE})
    robot = stand_in(("ar2", "joint"), "ar2", BOARD, numbers)
    return alone(robot, {BOARD: station}, motors, cluster, on_ptys=on_pty)


def _places(board: "Ar2Board") -> str:
    """Return where the joints are, in degrees."""
    from emulators.arduino_omni.ar2.axes import JOINTS

    angles = zip(JOINTS, board.joints.angles, strict=True)
    return ", ".join(f"{axis.name} {angle:.2f}" for axis, angle in angles)


emulate: Final = emulating(Ar2Options, EXAMPLES, start)
