"""Plain servos at the command line: `emulate cia402`."""

from dataclasses import dataclass
from typing import Annotated, Final

import typer

from emulators.cli.emulation import Emulation, emulating
from emulators.servo.motor import MOTOR, SUPPLY_MV, DcMotor
from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.cli.options import BitRateOption, ChannelOption, DurationOption, InterfaceOption
from firmware_bridge.cli.outside import Outside
from firmware_bridge.cli.recorded import RecordOption
from firmware_bridge.node import CAN
from firmware_bridge.runtime.black_box import CAN_LOG
from firmware_bridge.units import QUADCOUNTS_PER_LINE

EXAMPLES: Final = """Examples:

`firmware-bridge emulate cia402 --node 1 -i socketcan -c vcan0`

`firmware-bridge emulate cia402 --node 1-3 --encoder 1024 --load 5e-5,0.002 -i socketcan -c vcan0`

`firmware-bridge emulate cia402 --variation late-boot-up,period-first -i socketcan -c vcan0`"""
DEFAULT_BIT_RATE: Final = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoOptions:
    """Put plain CiA 402 servos on a real CAN bus, in real time, each with a motor and a load.

    For developers of a master whose drive is of no family here: objects, modes (pp, pv, hm, csp, csv, cst),
    option codes and default PDOs are those of the profile. Positions are in counts of the encoder, speeds in
    rpm. Ends on Ctrl-C.
    """

    interface: InterfaceOption = None
    channel: ChannelOption = None
    bit_rate: BitRateOption = None
    node: Annotated[
        str, typer.Option("--node", "-n", metavar="NUMBERS", help="Nodes: 1, or 1-8, or 1,3,5-7.")
    ] = "1"
    encoder: Annotated[
        int, typer.Option(min=16, max=100_000, metavar="PULSES", help="Pulses of the encoder in one turn.")
    ] = 500
    load: Annotated[
        str,
        typer.Option(
            metavar="INERTIA,FRICTION", help="At each motor, the rotor's own included: kg m2 and N m."
        ),
    ] = f"{MOTOR.inertia:g},{MOTOR.friction:g}"
    supply: Annotated[
        float, typer.Option(min=0.0, max=100.0, metavar="VOLTS", help="Supply voltage of the power stages.")
    ] = SUPPLY_MV / 1000
    variation: Annotated[
        str | None,
        typer.Option(
            metavar="NAME[,NAME]",
            help="What a difficult but lawful drive does otherwise; docs/variations.md has the names.",
            show_default=False,
        ),
    ] = None
    record: RecordOption = None
    duration: DurationOption = None


def start(given: ServoOptions) -> Emulation:
    """Make the servos of `emulate cia402`; an error ends the program with a message."""
    from emulators.cia402.servo import BIT_RATES
    from emulators.cia402.single import servos
    from emulators.cia402.variations import PLAIN, VariationError, traits_of
    from emulators.cli.watched import RollCalled, duplicates_reported
    from emulators.gateway import Cluster
    from firmware_bridge.cli.links import opened
    from firmware_bridge.cli.node_numbers import numbers

    nodes = numbers(given.node)
    rate = given.bit_rate or DEFAULT_BIT_RATE
    if rate not in BIT_RATES.values():
        raise refusal(f"--bitrate {rate}: the servo knows {', '.join(map(str, BIT_RATES.values()))}")
    with one_message(VariationError):
        traits = traits_of(given.variation.split(",")) if given.variation else PLAIN
    made, bank = servos(
        nodes,
        _motor(given.load),
        traits,
        counts=QUADCOUNTS_PER_LINE * given.encoder,
        supply_mv=round(given.supply * 1000),
        bus_rate=rate,
    )
    places = [(CAN, node) for node in nodes]
    outside = Outside(interface=given.interface, channel=given.channel, bit_rate=given.bit_rate)
    return Emulation(
        node=duplicates_reported(Cluster(made, bank), places),
        opened=lambda: opened(outside, "", 0, DEFAULT_BIT_RATE, any_rate=True),
        text=lambda where: (
            f"CiA 402 servo on {where}: node {given.node}; encoder with {given.encoder} pulses, "
            f"load {given.load} (kg m2, N m){_varied(given.variation)}"
        ),
        files={CAN: CAN_LOG},
        around=lambda node: RollCalled(node, places),
    )


def _motor(load: str) -> DcMotor:
    try:
        inertia, friction = (float(part) for part in load.split(","))
    except ValueError:
        raise refusal(f"--load {load}: give INERTIA,FRICTION in kg m2 and N m, as 2e-5,0.001") from None
    if not (0.0 < inertia < float("inf") and 0.0 <= friction < float("inf")):
        raise refusal(f"--load {load}: the inertia must be more than 0, the friction not less")
    return DcMotor(
        MOTOR.resistance, MOTOR.inductance, MOTOR.torque_constant, inertia, friction, MOTOR.damping
    )


def _varied(variation: str | None) -> str:
    return "" if variation is None else f"; {variation}"


emulate: Final = emulating(ServoOptions, EXAMPLES, start)
