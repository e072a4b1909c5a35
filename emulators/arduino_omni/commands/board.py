"""An Arduino with a motor shield at the command line: `emulate board`."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.arduino_omni.commands.line import LineOptions, checked, line_opened
from emulators.cli.emulation import Emulation, emulating
from emulators.cli.options import ControlOption, FaultOption, plant_file
from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.cli.live_page import LiveOption
from firmware_bridge.cli.options import DurationOption
from firmware_bridge.cli.plot_option import PlotOption
from firmware_bridge.cli.recorded import RecordOption
from firmware_bridge.node import SERIAL
from firmware_bridge.recording import device_side
from firmware_bridge.runtime.black_box import SERIAL_LOG

if TYPE_CHECKING:
    from emulators.arduino_omni.board import Board, Firmware
    from emulators.arduino_omni.motors import MotorLoad
    from emulators.control.live import Live
    from emulators.gateway import Cluster
    from firmware_bridge.robot import AnyRobot


EXAMPLES: Final = """Examples:

`firmware-bridge emulate board --firmware ros-arduino-bridge --serial pty --serial-link board.tty`

`firmware-bridge emulate board --firmware mw --encoders 3 --serial pty --record runs`

`firmware-bridge emulate board --firmware ros-arduino-bridge --auto-stop-ms 500 --plant three_wheels.fmu`

`firmware-bridge emulate board --firmware mw --fault current_limit --fault encoder_cable_off,node=M1@20-30`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardOptions(LineOptions):
    """Put an Arduino Mega 2560 with an Adafruit Motor Shield V2 on a serial line, in real time.

    For developers of a client without a board at hand. It is on at once, and receives nothing for the boot
    loader's 1.1 s. A pseudo-terminal has no DTR: a client that opens it resets nothing, where a real board
    would, unless --reset-on-open is given. Motors turn at all four terminals, encoders are on the first three
    (pins 2 and 3, 18 and 19, 10 and 11). Ends on Ctrl-C.
    """

    firmware: Annotated[
        str,
        typer.Option(help="Firmware: mw, ros-arduino-bridge, arduinoio or firmata."),
    ]
    encoders: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Number of encoders that it counts: 2 or 3; firmata 0 (StandardFirmata) or 2 "
            "(ConfigurableFirmata).",
            show_default="3 with ros-arduino-bridge, 0 with firmata, else 2",
        ),
    ] = None
    auto_stop_ms: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=32_767,
            metavar="N",
            help="With ros-arduino-bridge: time without a command after which it stops its motors.",
            show_default="2000",
        ),
    ] = None
    supply: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=15.0,
            metavar="VOLTS",
            help="Voltage of the motors' supply.",
            show_default="12, or the plant's battery_voltage",
        ),
    ] = None
    plant: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FMU",
            help="What the motors turn, in place of a flywheel each: a plant of `fmu list`, or any FMU with "
            "inputs voltage_AXIS and outputs current_AXIS, angle_AXIS and speed_AXIS of the motors' shafts, "
            "in SI, and a parameter torque_constant_AXIS, or one for all.",
            show_default=False,
        ),
    ] = None
    axes: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="The plant's axes in the order of the terminals M1 to M4.",
            show_default="as the plant has them",
        ),
    ] = None
    record: RecordOption = None
    control: ControlOption = "unix"
    plotjuggler: PlotOption = None
    fault: FaultOption = None
    live: LiveOption = False
    duration: DurationOption = None


BOARD: Final = "board"
"""Name of the board's link."""
NOT_STOCK: Final = ", not stock"


def start(given: BoardOptions) -> Emulation:
    """Make the board of `emulate motor_shield`; an error ends the program with a message."""
    from emulators.arduino_omni.board import Board
    from emulators.arduino_omni.commands.reported import keeping_reported
    from emulators.arduino_omni.mega.mega import SketchError
    from emulators.arduino_omni.motors import SUPPLY_V
    from emulators.gateway import Cluster
    from emulators.servo.seam import ServoError
    from fmu.errors import PlantError

    checked(given)
    firmware = _firmware(given)
    encoders = firmware.encoders[0] if given.encoders is None else given.encoders
    load = _load(given)
    board = Board(
        firmware,
        load,
        encoders=encoders,
        auto_stop=given.auto_stop_ms,
        supply=SUPPLY_V if given.supply is None else given.supply,
    )
    keeping_reported(board.mega)
    stock = "" if encoders in firmware.stock else NOT_STOCK
    called = {SERIAL: device_side("board", given.firmware)}
    cluster = Cluster({BOARD: board}, links={BOARD: {SERIAL: SERIAL}})
    return Emulation(
        node=cluster,
        opened=partial(line_opened, given, firmware.baud),
        text=lambda where: (
            f"{firmware.title} ({encoders} encoders{stock}) on {where}: motors {', '.join(load.names)}"
        ),
        errors=(PlantError, ServoError, SketchError),
        files={SERIAL: SERIAL_LOG},
        called=called,
        live=lambda: _live(board, load.names, cluster, on_pty=given.on_pty),
    )


def _live(board: "Board", names: tuple[str, ...], cluster: "Cluster", *, on_pty: bool) -> "Live":
    from emulators.arduino_omni.shield_motors import ShieldMotor
    from emulators.control.alone import alone
    from emulators.family import Station, Way

    motors = [ShieldMotor(axis, board, port) for port, axis in enumerate(names, start=1)]
    station = Station(board, BOARD, {SERIAL: Way.LINE})
    return alone(alone_on_line(names), {BOARD: station}, motors, cluster, on_ptys=on_pty)


def alone_on_line(names: Sequence[str]) -> "AnyRobot":
    """Return a stand-in for the robot of a board, with the names of its motors by terminal."""
    from emulators.control.alone import stand_in

    ports = {axis: port for port, axis in enumerate(names, start=1)}
    return stand_in(("rome", "port"), "board", BOARD, ports)


def _firmware(given: BoardOptions) -> "Firmware":
    from emulators.arduino_omni.board import FIRMWARES

    found = FIRMWARES.get(given.firmware)
    if found is None:
        raise refusal(f"--firmware {given.firmware}: there is none; there are: {', '.join(FIRMWARES)}")
    if given.encoders is not None and given.encoders not in found.encoders:
        known = " or ".join(map(str, sorted(found.encoders)))
        raise refusal(f"--encoders {given.encoders}: {given.firmware} counts {known}")
    if given.auto_stop_ms is not None and found.auto_stop is None:
        raise refusal(
            f"--auto-stop-ms {given.auto_stop_ms}: {given.firmware} has no auto-stop; its motors run on until"
            " they are commanded otherwise"
        )
    return found


def _load(given: BoardOptions) -> "MotorLoad":
    from emulators.arduino_omni.fmu_load import fmu_load
    from emulators.arduino_omni.motors import four_motors
    from fmu.errors import PlantError

    if given.plant is None and given.axes is not None:
        raise refusal(
            f"--axes {given.axes}: there is no plant whose axes those could be; name one by --plant"
        )
    if given.plant is None:
        return four_motors()
    with one_message(PlantError):
        load = fmu_load(plant_file(given.plant), given.axes.split(",") if given.axes else ())
    return load if given.supply is None else replace(load, supply=None)


emulate: Final = emulating(BoardOptions, EXAMPLES, start)
