"""What `emulate cia402` and `emulate canopen` share: the options of a bus, and devices put on it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.cli.emulation import Emulation
from emulators.cli.options import ControlOption, FaultOption, ParametersOption
from emulators.servo.motor import SUPPLY_MV
from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.cli.live_page import LiveOption
from firmware_bridge.cli.options import BitRateOption, ChannelOption, DurationOption, InterfaceOption
from firmware_bridge.cli.outside import Outside
from firmware_bridge.cli.plot_option import PlotOption
from firmware_bridge.cli.recorded import RecordOption
from firmware_bridge.node import CAN, Node
from firmware_bridge.runtime.black_box import CAN_LOG
from firmware_bridge.units import QUADCOUNTS_PER_LINE

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from emulators.canopen.saved_parameters import Storage
    from emulators.control.live import Live
    from emulators.servo.axis import ServoAxis
    from emulators.servo.motor import DcMotor
    from firmware_bridge.robot import AnyRobot

DEFAULT_BIT_RATE: Final = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class BusOptions:
    """Options of devices on one CAN bus."""

    interface: InterfaceOption = None
    channel: ChannelOption = None
    bit_rate: BitRateOption = None
    node: Annotated[
        str, typer.Option("--node", "-n", metavar="NUMBERS", help="Nodes: 1, or 1-8, or 1,3,5-7.")
    ] = "1"
    encoder: Annotated[
        int,
        typer.Option(min=16, max=100_000, metavar="PULSES", help="Pulses of a drive's encoder in a turn."),
    ] = 500
    parameters: ParametersOption = None
    record: RecordOption = None
    control: ControlOption = "unix"
    plotjuggler: PlotOption = None
    fault: FaultOption = None
    live: LiveOption = False
    duration: DurationOption = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Fitted:
    """What is put on the bus: motors, and devices at them."""

    product: str
    """Its name in the files of saved parameters."""
    motor: "DcMotor"
    made: "Callable[[int, ServoAxis, Storage, int], Node]"
    """Make one of its node number, its motor's axis, what keeps its parameters, and the bit rate in bit/s."""
    supply_mv: int = SUPPLY_MV
    text: str
    """For people, with WHERE for the bus."""


def on_bus(given: BusOptions, fitted: Fitted) -> Emulation:
    """Put devices on the bus; an error ends the program with a message."""
    from emulators.canopen.saved_parameters import StorageError
    from emulators.cia402.servo import BIT_RATES
    from emulators.cia402.single import with_motors
    from emulators.cli.watched import RollCalled, duplicates_reported
    from emulators.gateway import Cluster
    from emulators.parameter_files import storage_in
    from firmware_bridge.cli.links import opened
    from firmware_bridge.cli.node_numbers import numbers

    nodes = numbers(given.node)
    rate = given.bit_rate or DEFAULT_BIT_RATE
    if rate not in BIT_RATES.values():
        raise refusal(f"--bitrate {rate}: known are {', '.join(map(str, BIT_RATES.values()))}")

    def made(node: int, axis: "ServoAxis") -> Node:
        return fitted.made(node, axis, storage_in(given.parameters, node, fitted.product), rate)

    with one_message(StorageError):
        devices, bank = with_motors(
            nodes,
            made,
            fitted.motor,
            counts=QUADCOUNTS_PER_LINE * given.encoder,
            supply_mv=fitted.supply_mv,
        )
    places = [(CAN, node) for node in nodes]
    cluster = Cluster(devices, bank)

    def live() -> "Live":
        from emulators.control.alone import alone
        from emulators.family import Station, Way

        stations = {name: Station(one, CAN, {CAN: Way.BUS}) for name, one in devices.items()}
        robot = alone_on_bus(fitted.product, dict(zip(devices, nodes, strict=True)))
        return alone(robot, stations, bank.axes, cluster)

    outside = Outside(interface=given.interface, channel=given.channel, bit_rate=given.bit_rate)
    return Emulation(
        node=duplicates_reported(cluster, places),
        opened=lambda: opened(outside, "", 0, DEFAULT_BIT_RATE, any_rate=True),
        text=lambda where: fitted.text.replace("WHERE", where),
        files={CAN: CAN_LOG},
        around=lambda node: RollCalled(node, places),
        live=live,
    )


def alone_on_bus(product: str, nodes: "Mapping[str, int]") -> "AnyRobot":
    """Return a stand-in for the robot of drives, with their nodes by name."""
    from emulators.control.alone import stand_in

    return stand_in(("servo_axis", "node"), product, CAN, nodes)
