"""A device from its EDS at the command line: `emulate canopen`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from emulators.cia402.commands.on_bus import BusOptions, Fitted, on_bus
from emulators.cli.emulation import Emulation, emulating
from firmware_bridge.cli.console import one_message

EXAMPLES: Final = """Examples:

`firmware-bridge emulate canopen --eds drive.eds --node 3 -i socketcan -c vcan0`

`firmware-bridge emulate canopen --eds io.eds --node 10-12 -i socketcan -c vcan0`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class EdsOptions(BusOptions):
    """Put devices on a real CAN bus as their EDS describes them, in real time.

    Dictionary, NMT, SDO, PDO, heartbeat, SYNC and emergencies are CiA 301's over the objects in the file;
    with a Controlword and a Statusword it is a drive of CiA 402, with a motor and a load. What a maker's own
    objects do is not known: they keep what is written. Ends on Ctrl-C.
    """

    eds: Annotated[Path, typer.Option("--eds", metavar="FILE", help="The EDS of the device.")]


def start(given: EdsOptions) -> Emulation:
    """Make the devices of `emulate canopen`; an error ends the program with a message."""
    from emulators.cia402.eds_device import PRODUCT_NAME, DeviceOfEds, is_drive
    from emulators.servo.motor import MOTOR
    from firmware_bridge.runtime.data_sheets import SheetError, objects

    with one_message(SheetError):
        rows = objects(given.eds)
    kind = "a drive of CiA 402" if is_drive(rows) else "no drive"
    return on_bus(
        given,
        Fitted(
            product=PRODUCT_NAME,
            motor=MOTOR,
            made=lambda node, axis, storage, rate: DeviceOfEds(
                node, rows, axis, storage=storage, bus_rate=rate
            ),
            text=f"{given.eds.name} on WHERE: node {given.node}; {len(rows)} objects, {kind}",
        ),
    )


emulate: Final = emulating(EdsOptions, EXAMPLES, start)
