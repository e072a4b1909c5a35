"""A device from its EDS at the command line: `emulate canopen`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from emulators.cli.emulation import Emulation, emulating
from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.cli.options import BitRateOption, ChannelOption, DurationOption, InterfaceOption
from firmware_bridge.cli.outside import Outside
from firmware_bridge.cli.recorded import RecordOption
from firmware_bridge.node import CAN
from firmware_bridge.runtime.black_box import CAN_LOG
from firmware_bridge.units import QUADCOUNTS_PER_LINE

EXAMPLES: Final = """Examples:

`firmware-bridge emulate canopen --eds drive.eds --node 3 -i socketcan -c vcan0`

`firmware-bridge emulate canopen --eds io.eds --node 10-12 -i socketcan -c vcan0`"""
DEFAULT_BIT_RATE: Final = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class EdsOptions:
    """Put devices on a real CAN bus as their EDS describes them, in real time.

    Dictionary, NMT, SDO, PDO, heartbeat, SYNC and emergencies are CiA 301's over the objects in the file;
    with a Controlword and a Statusword it is a drive of CiA 402, with a motor and a load. What a maker's own
    objects do is not known: they keep what is written. Ends on Ctrl-C.
    """

    eds: Annotated[Path, typer.Option("--eds", metavar="FILE", help="The EDS of the device.")]
    interface: InterfaceOption = None
    channel: ChannelOption = None
    bit_rate: BitRateOption = None
    node: Annotated[
        str, typer.Option("--node", "-n", metavar="NUMBERS", help="Nodes: 1, or 1-8, or 1,3,5-7.")
    ] = "1"
    encoder: Annotated[
        int,
        typer.Option(min=16, max=100_000, metavar="PULSES", help="Of a drive's encoder, in one turn."),
    ] = 500
    record: RecordOption = None
    duration: DurationOption = None


def start(given: EdsOptions) -> Emulation:
    """Make the devices of `emulate canopen`; an error ends the program with a message."""
    from emulators.cia402.eds_device import DeviceOfEds, is_drive
    from emulators.cia402.servo import BIT_RATES
    from emulators.cli.watched import RollCalled, duplicates_reported
    from emulators.gateway import Cluster
    from emulators.servo.axis import ServoAxis
    from emulators.servo.bank import ServoBank
    from emulators.servo.motor import MOTOR, DcMotors
    from emulators.servo.winding import set_winding
    from firmware_bridge.cli.links import opened
    from firmware_bridge.cli.node_numbers import numbers
    from firmware_bridge.runtime.data_sheets import SheetError, objects

    nodes = numbers(given.node)
    rate = given.bit_rate or DEFAULT_BIT_RATE
    if rate not in BIT_RATES.values():
        raise refusal(f"--bitrate {rate}: known are {', '.join(map(str, BIT_RATES.values()))}")
    with one_message(SheetError):
        rows = objects(given.eds)
    axes = [ServoAxis(f"node{node}", QUADCOUNTS_PER_LINE * given.encoder) for node in nodes]
    for axis in axes:
        set_winding(axis, MOTOR.torque_constant, MOTOR.resistance, MOTOR.inductance)
    made = {
        axis.name: DeviceOfEds(node, rows, axis, bus_rate=rate)
        for axis, node in zip(axes, nodes, strict=True)
    }
    places = [(CAN, node) for node in nodes]
    outside = Outside(interface=given.interface, channel=given.channel, bit_rate=given.bit_rate)
    kind = "a drive of CiA 402" if is_drive(rows) else "no drive"
    return Emulation(
        node=duplicates_reported(Cluster(made, ServoBank(DcMotors((MOTOR,) * len(axes)), axes)), places),
        opened=lambda: opened(outside, "", 0, DEFAULT_BIT_RATE, any_rate=True),
        text=lambda where: f"{given.eds.name} on {where}: node {given.node}; {len(rows)} objects, {kind}",
        files={CAN: CAN_LOG},
        around=lambda node: RollCalled(node, places),
    )


emulate: Final = emulating(EdsOptions, EXAMPLES, start)
