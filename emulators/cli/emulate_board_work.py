"""Puts an emulated Arduino with a motor shield on a real serial line, in real time."""

from dataclasses import replace
from pathlib import Path
from typing import Final

from emulators.arduino_omni.board import FIRMWARES, Board, Firmware
from emulators.arduino_omni.faults import FaultyBoard, Planned, planned
from emulators.arduino_omni.mega.mega import SketchError
from emulators.arduino_omni.motors import SUPPLY_V, Load, four_motors
from emulators.boards import fmu_load
from emulators.cli.emulate_board import BoardOptions
from emulators.servo.seam import ServoError
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
from fmu.build import ensure, is_built
from fmu.errors import PlantError

NOT_STOCK: Final = ", not stock"


def emulate(given: BoardOptions) -> None:
    """Do what `emulate board` says; what is wrong ends the program with a message."""
    firmware = _firmware(given)
    encoders = firmware.encoders[0] if given.encoders is None else given.encoders
    plan = _plan(given)
    load = _load(given)
    board = Board(
        firmware,
        load,
        encoders=encoders,
        auto_stop=given.auto_stop_ms,
        supply=SUPPLY_V if given.supply is None else given.supply,
    )
    stock = "" if encoders in firmware.stock else NOT_STOCK
    with recording(given.record, {SERIAL: SERIAL_LOG}) as (around, _):
        with one_message(PortError):
            line = open_serial(given.serial, firmware.baud, given.serial_link, tells_dtr=given.reset_on_open)
        carry(
            around(FaultyBoard(board, plan)),
            {SERIAL: lambda: line},
            until(given.duration),
            f"{firmware.title} ({encoders} encoders{stock}) on {line.name}: motors {', '.join(load.names)}",
            PlantError,
            ServoError,
            SketchError,
            clock=LivedClock(),
        )


def _firmware(given: BoardOptions) -> Firmware:
    found = FIRMWARES.get(given.firmware)
    if found is None:
        raise refusal(f"--firmware {given.firmware}: there is none; there are: {', '.join(FIRMWARES)}")
    if given.encoders is not None and given.encoders not in found.encoders:
        known = " or ".join(map(str, sorted(found.encoders)))
        raise refusal(f"--encoders {given.encoders}: {given.firmware} counts {known}")
    if given.auto_stop_ms is not None and found.auto_stop is None:
        raise refusal(
            f"--auto-stop-ms {given.auto_stop_ms}: {given.firmware} has no auto-stop; its motors run on until"
            " they are told otherwise"
        )
    return found


def _plan(given: BoardOptions) -> list[Planned]:
    try:
        plan = [planned(text) for text in given.fault or ()]
    except ValueError as error:
        raise refusal(f"--fault {error}") from None
    if given.reset_on_open and given.serial != WORD:
        raise refusal(
            f"--reset-on-open: on {given.serial} the device itself decides; only --serial pty needs it"
        )
    return plan


def _load(given: BoardOptions) -> Load:
    if given.plant is None and given.axes is not None:
        raise refusal(
            f"--axes {given.axes}: there is no plant whose axes those could be; name one by --plant"
        )
    if given.plant is None:
        return four_motors()
    with one_message(PlantError):
        load = fmu_load(_file(given.plant), given.axes.split(",") if given.axes else ())
    return load if given.supply is None else replace(load, supply=None)


def _file(plant: str) -> Path:
    """Return the FMU of this name: a file, or a plant that is built where that has not been done."""
    path = Path(plant)
    if path.suffix == ".fmu" or path.exists():
        return path
    if not is_built(plant):
        say(f"building the plant {plant}, once")
    return ensure(plant)
