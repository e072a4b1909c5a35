"""Drives without a robot at the command line: `emulate epos2`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from emulators.cli.options import LatencyOption, ParametersOption, ProfileOption
from emulators.epos2.objects.device_profile import BAUDS
from emulators.servo.motor import MOTOR, SUPPLY_MV
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.options import (
    DurationOption,
)
from firmware_bridge.cli.outside import Outside
from firmware_bridge.cli.recorded import RecordOption
from firmware_bridge.wire.maxon.frame import Generation

EXAMPLES: Final = """Examples:

`firmware-bridge emulate epos2 --node 1 --profile 70/10 -i socketcan -c vcan0`

`firmware-bridge emulate epos2 --node 1-8 --load 5e-5,0.002 -i socketcan -c vcan0`

`firmware-bridge emulate epos2 --node 1-2 --plant my.fmu --axes left,right -i socketcan -c vcan0`

`firmware-bridge emulate epos2 --node 1-4 --serial pty --serial-link epos2.tty --serial-node 2`

`firmware-bridge emulate epos2 --choice mapping-needs-invalid-pdo=yes --choice boot-time=1s -i socketcan -c
vcan0`

`firmware-bridge emulate epos2 --plant single_axis.fmu --axes axis --set stop_low=-1 -i socketcan -c vcan0`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivesOptions(Outside):
    """Put EPOS2 drives on a real CAN bus, a serial line, or both, in real time, each with a motor and a load.

    For whoever develops a master and has no drive at hand. With --serial and neither -i nor -c the CAN bus is
    inside; the line reaches the other drives through it. Ends on Ctrl-C.
    """

    node: Annotated[
        str, typer.Option("--node", "-n", metavar="NUMBERS", help="Which nodes: 1, or 1-8, or 1,3,5-7.")
    ] = "1"
    protocol: Annotated[
        Generation | None,
        typer.Option(
            help="What the serial line speaks: v1 as on RS232, v2 as on USB.",
            show_default="as its host does",
        ),
    ] = None
    profile: ProfileOption = "70/10"
    load: Annotated[
        str | None,
        typer.Option(
            metavar="INERTIA,FRICTION",
            help="At each shaft, the rotor's own included: kg m2 and N m.",
            show_default=f"{MOTOR.inertia:g},{MOTOR.friction:g}",
        ),
    ] = None
    plant: Annotated[
        Path | None,
        typer.Option(
            metavar="FMU",
            help="A plant in place of the motors: inputs voltage_AXIS, outputs current_AXIS, angle_AXIS and "
            "speed_AXIS of the shaft, in SI, for each axis; switches and brake where it has them.",
            show_default=False,
        ),
    ] = None
    values: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="A parameter of the plant, in SI; may be given more than once.",
            show_default=False,
        ),
    ] = None
    axes: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="The plant's axes in the order of the nodes.",
            show_default="motor1,motor2 ...",
        ),
    ] = None
    supply: Annotated[
        float, typer.Option(min=0.0, max=100.0, metavar="VOLTS", help="The supply of the power stages.")
    ] = SUPPLY_MV / 1000
    parameters: ParametersOption = None
    dip_off: Annotated[
        bool,
        typer.Option("--dip-off", help="DIP switch at 0: the number saved in 0x2000 counts, 1 at first."),
    ] = False
    realistic_latency: LatencyOption = True
    choice: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="What the sources leave open, otherwise than by default; may be given more than once. "
            "`epos2 fidelity` lists every choice, its default and the evidence.",
            show_default=False,
        ),
    ] = None
    baud: Annotated[
        int | None,
        typer.Option(
            metavar="RATE",
            help=f"What the drive on an RS232 line has in 0x2002: {', '.join(map(str, BAUDS))}.",
            show_default=f"{BAUDS[-1]}",
        ),
    ] = None
    record: RecordOption = None
    duration: DurationOption = None


emulate: Final = command(EXAMPLES, work="emulators.cli.emulate_epos2_work:emulate")(DrivesOptions)
