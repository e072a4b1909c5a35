"""An Arduino with a motor shield at the command line: `emulate board`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.options import DurationOption
from firmware_bridge.cli.recorded import RecordOption

EXAMPLES: Final = """Examples:

`firmware-bridge emulate board --firmware ros-arduino-bridge --serial pty --serial-link board.tty`

`firmware-bridge emulate board --firmware mw --encoders 3 --serial pty --record runs`

`firmware-bridge emulate board --firmware ros-arduino-bridge --auto-stop-ms 500 --plant three_wheels.fmu`

`firmware-bridge emulate board --firmware mw --fault current-limit --fault encoder-1@20-30`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardOptions:
    """Put an Arduino Mega 2560 with an Adafruit Motor Shield V2 on a serial line, in real time.

    For whoever writes a client and has no board at hand. It is on from the beginning, and deaf for the boot
    loader's 1.1 s. A pseudo-terminal has no DTR: a client that opens it resets nothing, where a real
    board would begin anew, unless --reset-on-open says so. Motors turn at all four terminals, encoders are on
    the first three (pins 2 and 3, 18 and 19, 10 and 11). Ends on Ctrl-C.
    """

    firmware: Annotated[
        str,
        typer.Option(help="What is flashed: mw, ros-arduino-bridge, arduinoio or firmata."),
    ]
    encoders: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="How many encoders it counts: 2 or 3; firmata 0 (StandardFirmata) or 2 "
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
            help="With ros-arduino-bridge: after how long without a command it stops its motors.",
            show_default="2000",
        ),
    ] = None
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
    fault: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[@FROM[-TO]]",
            help="What is wrong, from and to a time in s; again for each: current-limit, over-temperature, "
            "hangs, brown-out, unpowered, supply-sag, cable-1 to cable-4, blocked-1 to blocked-4, "
            "lifted-1 to lifted-4, leads-1 to leads-4, encoder-1 to encoder-3, channels-1 to channels-3, "
            "shield-absent, i2c-stuck.",
            show_default=False,
        ),
    ] = None
    supply: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=15.0,
            metavar="VOLTS",
            help="The motors' supply.",
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
    duration: DurationOption = None


emulate: Final = command(EXAMPLES, work="emulators.cli.emulate_board_work:emulate")(BoardOptions)
