"""Plain servos at the command line: `emulate cia402`."""

from dataclasses import dataclass
from typing import Annotated, Final

import typer

from emulators.cia402.commands.on_bus import BusOptions, Fitted, on_bus
from emulators.cli.emulation import Emulation, emulating
from emulators.servo.motor import MOTOR, SUPPLY_MV, DcMotor
from firmware_bridge.cli.console import one_message, refusal

EXAMPLES: Final = """Examples:

`firmware-bridge emulate cia402 --node 1 -i socketcan -c vcan0`

`firmware-bridge emulate cia402 --node 1-3 --encoder 1024 --load 5e-5,0.002 -i socketcan -c vcan0`

`firmware-bridge emulate cia402 --variation late-boot-up,period-first -i socketcan -c vcan0`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoOptions(BusOptions):
    """Put plain CiA 402 servos on a real CAN bus, in real time, each with a motor and a load.

    For developers of a master whose drive is of no family here: objects, modes (pp, pv, hm, csp, csv, cst),
    option codes and default PDOs are those of the profile. Positions are in counts of the encoder, where
    0x608F, 0x6091 and 0x6092 give no other unit, speeds in rpm. Ends on Ctrl-C.
    """

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


def start(given: ServoOptions) -> Emulation:
    """Make the servos of `emulate cia402`; an error ends the program with a message."""
    from emulators.cia402.servo import PRODUCT, Servo
    from emulators.cia402.variations import PLAIN, VariationError, traits_of

    with one_message(VariationError):
        traits = traits_of(given.variation.split(",")) if given.variation else PLAIN
    varied = "" if given.variation is None else f"; {given.variation}"
    return on_bus(
        given,
        Fitted(
            product=PRODUCT.name,
            motor=_motor(given.load),
            made=lambda node, axis, storage, rate: Servo(node, axis, traits, storage=storage, bus_rate=rate),
            supply_mv=round(given.supply * 1000),
            text=f"CiA 402 servo on WHERE: node {given.node}; encoder with {given.encoder} pulses, "
            f"load {given.load} (kg m2, N m){varied}",
        ),
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


emulate: Final = emulating(ServoOptions, EXAMPLES, start)
