"""Drives without a robot at the command line: `emulate epos2`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.cli.emulation import Emulation, emulating
from emulators.cli.options import ControlOption, FaultOption, LatencyOption, ParametersOption, plant_file
from emulators.epos2.commands.options import ProfileOption, find_profile
from emulators.epos2.objects.device_profile import BAUDS, BIT_RATES, DeviceProfile, realistic
from emulators.servo.motor import MOTOR, SUPPLY_MV
from firmware_bridge.cli.commands import completing
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.live_page import LiveOption
from firmware_bridge.cli.options import (
    DurationOption,
)
from firmware_bridge.cli.outside import Outside
from firmware_bridge.cli.plot_option import PlotOption
from firmware_bridge.cli.recorded import RecordOption
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.recording import device_side
from firmware_bridge.runtime.black_box import CAN_LOG, SERIAL_LOG

if TYPE_CHECKING:
    from emulators.control.live import Live
    from emulators.epos2.drive import Epos2
    from emulators.epos2.mounted import Mounted, ShaftLoad
    from emulators.epos2.single import DrivesOrder
    from emulators.gateway import Cluster
    from emulators.servo.bank import ServoBank
    from firmware_bridge.canopen.address import Address
    from firmware_bridge.robot import AnyRobot

EXAMPLES: Final = """Examples:

`firmware-bridge emulate epos2 --node 1 --profile 70/10 -i socketcan -c vcan0`

`firmware-bridge emulate epos2 --node 1-8 --load 5e-5,0.002 -i socketcan -c vcan0`

`firmware-bridge emulate epos2 --motor 148867 --encoder 1024 --gear 26 --load 0.002,0.05 -i socketcan -c
vcan0`

`firmware-bridge emulate epos2 --profile 50/5 --motor "EC 45 flat 70W 24V" --encoder 2048,no-index --dcf
drive.dcf --serial pty`

`firmware-bridge emulate epos2 --node 1-2 --plant my.fmu --axes left,right -i socketcan -c vcan0`

`firmware-bridge emulate epos2 --node 1-4 --serial pty --serial-link epos2.tty --serial-node 2`

`firmware-bridge emulate epos2 --choice mapping-needs-invalid-pdo=yes --choice boot-time=1s -i socketcan -c
vcan0`

`firmware-bridge emulate epos2 --plant single_axis --axes axis --set stop_low=-1 -i socketcan -c vcan0`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivesOptions(Outside):
    """Put EPOS2 drives on a real CAN bus, a serial line, or both, in real time, each with a motor and a load.

    For developers of a master without a drive at hand. With --serial and neither -i nor -c the CAN bus is
    inside; the line reaches the other drives through it. Ends on Ctrl-C.
    """

    node: Annotated[
        str, typer.Option("--node", "-n", metavar="NUMBERS", help="Nodes: 1, or 1-8, or 1,3,5-7.")
    ] = "1"
    protocol: Annotated[
        Generation | None,
        typer.Option(
            help="Protocol of the serial line: v1 as on RS232, v2 as on USB.",
            show_default="as its host does",
        ),
    ] = None
    profile: ProfileOption = "70/10"
    load: Annotated[
        str | None,
        typer.Option(
            metavar="INERTIA,FRICTION",
            help="At each motor: kg m2 and N m. With --motor what its gear turns, without it the rotor's own "
            "included.",
            show_default=f"nothing, or without --motor {MOTOR.inertia:g},{MOTOR.friction:g}",
        ),
    ] = None
    motor: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|ORDER-NUMBER|FILE.toml",
            help="The motor at each drive, as in `new --motor`: a known one, or a file with its data. An "
            "EC motor is emulated as its equivalent DC motor.",
            show_default="no particular one, with which any motor type 0x6402 is right",
            autocompletion=completing("emulators.motors:names"),
        ),
    ] = None
    encoder: Annotated[
        str,
        typer.Option(
            metavar="PULSES[,no-index]|NAME|ORDER-NUMBER",
            help="The encoder at each motor: pulses per turn, and no-index if it has no index channel; or "
            "a known one.",
            autocompletion=completing("emulators.fittings:encoder_names"),
        ),
    ] = "500"
    pole_pairs: Annotated[
        int | None,
        typer.Option(min=1, max=255, help="The motor's pole pairs.", show_default="as --motor has them"),
    ] = None
    gear: Annotated[
        str | None,
        typer.Option(
            metavar="RATIO|NAME|ORDER-NUMBER",
            help="Turns of the motor for one of the load, as 26 or 57/13; or a known gear, as 'GP 32 C "
            "23:1', with its inertia.",
            show_default="1",
        ),
    ] = None
    dcf: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Parameters of a drive, as `epos2 dcf` or EPOS Studio writes them (CiA 306), until others "
            "are saved.",
            show_default=False,
        ),
    ] = None
    plant: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FMU",
            help="A plant in place of the motors, of `fmu list`, or any FMU: inputs voltage_AXIS, outputs "
            "current_AXIS, angle_AXIS and speed_AXIS of the shaft, in SI, for each axis; switches and brake "
            "where it has them.",
            show_default=False,
        ),
    ] = None
    values: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="A parameter of the plant, in SI, as `fmu show` lists them; may be given more than once.",
            show_default=False,
        ),
    ] = None
    axes: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="The plant's axes in the order of the nodes.",
            show_default="the plant's own where there is one for each node, else motor1,motor2 ...",
        ),
    ] = None
    supply: Annotated[
        float, typer.Option(min=0.0, max=100.0, metavar="VOLTS", help="Supply voltage of the power stages.")
    ] = SUPPLY_MV / 1000
    parameters: ParametersOption = None
    dip_off: Annotated[
        bool,
        typer.Option("--dip-off", help="DIP switch at 0: the number saved in 0x2000 counts, 1 at first."),
    ] = False
    realistic_latency: LatencyOption = True
    boot_time: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help="From power-on or a reset to the boot-up message, as 262.5ms or 2s.",
            show_default="262.5ms, or 0ms with --no-latency",
        ),
    ] = None
    choice: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="A choice that the sources leave open, other than the default; may be repeated. `epos2 "
            "fidelity` lists every choice, its default and the evidence.",
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
    control: ControlOption = "unix"
    plotjuggler: PlotOption = None
    fault: FaultOption = None
    live: LiveOption = False
    duration: DurationOption = None


DEFAULT_BIT_RATE: Final = 1_000_000


def start(given: DrivesOptions) -> Emulation:
    """Make the drives of `emulate epos2`; an error ends the program with a message."""
    from emulators.canopen.saved_parameters import StorageError
    from emulators.cli.watched import RollCalled, duplicates_reported
    from emulators.epos2.commands.links import drives_opened
    from emulators.epos2.serial.serial_drive import baud_of
    from emulators.epos2.single import DrivesOrder, drives
    from emulators.gateway import Cluster
    from emulators.servo.bank import ServoError
    from firmware_bridge.cli.links import on_the_line
    from firmware_bridge.cli.node_numbers import numbers
    from fmu.errors import PlantError

    nodes = numbers(given.node)
    if given.dip_off and len(nodes) != 1:
        raise refusal("--dip-off: drives with their switches at 0 all begin as node 1; emulate one of them")
    names = tuple(given.axes.split(",")) if given.axes else ()
    if names and len(names) != len(nodes):
        raise refusal(
            f"--axes {given.axes}: there are {len(nodes)} nodes and {len(names)} axes; name one for each"
        )
    mounted = _mounted(given)
    with one_message(PlantError):
        plant = None if given.plant is None else plant_file(given.plant)
        names = names or _axes(plant, len(nodes))
    rate = given.bit_rate or DEFAULT_BIT_RATE
    near = on_the_line(given, nodes)
    order = DrivesOrder(
        nodes=nodes,
        profile=replace(
            _profile(given.profile, rate, _choices(given), latency=given.realistic_latency),
            rs232_rate=_rs232(given.baud, given.serial, given.protocol),
        ),
        bit_rate=rate,
        mounted=mounted,
        commissioned={} if given.dcf is None else _commissioned(given.dcf),
        plant=plant,
        plant_parameters=_settings(given.values or [], plant),
        axes=names,
        supply_mv=round(given.supply * 1000),
        parameters=given.parameters,
        dip_off=given.dip_off,
        serial={} if given.serial is None else {near: given.protocol},
    )
    with one_message(PlantError, StorageError, ServoError):
        made, bank = drives(order, say)
    owner = order.names[nodes.index(near)]
    line = "" if given.serial is None else f", node {near} on the line"
    cluster = Cluster(made, bank, links={owner: {CAN: CAN, SERIAL: SERIAL}})
    called = {SERIAL: device_side(f"node-{near}", SERIAL)}
    places = [(CAN, node) for node in nodes]
    return Emulation(
        node=duplicates_reported(cluster, places),
        opened=lambda: drives_opened(given, given.protocol, baud_of(made[owner]), DEFAULT_BIT_RATE),
        text=lambda where: (
            f"{order.profile.name} on {where}: node {given.node}{line}; {_text(mounted, plant)}"
        ),
        errors=(PlantError, ServoError),
        files={CAN: CAN_LOG, SERIAL: SERIAL_LOG},
        called=called,
        around=lambda node: RollCalled(node, places),
        live=lambda: _live(order, made, bank, cluster),
    )


def _live(order: "DrivesOrder", made: "Mapping[str, Epos2]", bank: "ServoBank", cluster: "Cluster") -> "Live":
    from emulators.control.alone import alone
    from emulators.family import Station, Way

    stations = {name: Station(drive, CAN, {CAN: Way.BUS}) for name, drive in made.items()}
    robot = alone_on_bus(dict(zip(order.names, order.nodes, strict=True)))
    return alone(robot, stations, bank.axes, cluster, bank.plant)


def alone_on_bus(nodes: "Mapping[str, int]") -> "AnyRobot":
    """Return a stand-in for the robot of drives, with their nodes by name."""
    from emulators.control.alone import stand_in

    return stand_in(("rars", "node"), "epos2", CAN, nodes)


def _axes(plant: Path | None, count: int) -> tuple[str, ...]:
    """Return the plant's own axes, where it has one for each node; else none, which are motor1 and so on."""
    from emulators.servo.fmu_axes import axes_of

    own = () if plant is None else axes_of(plant)
    return own if len(own) == count else ()


def _choices(given: DrivesOptions) -> list[str]:
    """Return the choices; that of the boot time has an option, too."""
    from emulators.epos2.objects.choices import ChoiceError, chosen

    if given.boot_time is None:
        return given.choice or []
    choice = f"boot-time={given.boot_time}"
    try:
        chosen(find_profile(given.profile), [choice])
    except ChoiceError:
        raise refusal(f"--boot-time {given.boot_time}: give a time, as 262.5ms or 2s, 60s at most") from None
    return [*(given.choice or ()), choice]


def _profile(name: str, rate: int, choices: Sequence[str], *, latency: bool) -> DeviceProfile:
    from emulators.epos2.objects.choices import ChoiceError, chosen

    codes = {bits: code for code, bits in BIT_RATES.items()}
    if rate not in codes:
        raise refusal(f"--bitrate {rate}: an EPOS2 knows {', '.join(map(str, codes))}")
    found = replace(find_profile(name), bit_rate=codes[rate])
    with one_message(ChoiceError):
        return chosen(realistic(found) if latency else found, choices)


def _rs232(baud: int | None, serial: str | None, protocol: Generation | None) -> int:
    """Return the code of a rate on RS232; what makes no sense ends the program with a message."""
    if baud is None:
        return len(BAUDS) - 1
    if serial is None or protocol is Generation.V2:
        raise refusal(f"--baud {baud}: only a line of RS232 has a rate; use --serial pty --protocol v1")
    if baud not in BAUDS:
        raise refusal(f"--baud {baud}: an EPOS2 knows {', '.join(map(str, BAUDS))}")
    return BAUDS.index(baud)


def _settings(values: Sequence[str], plant: Path | None) -> dict[str, float]:
    if values and plant is None:
        raise refusal(
            f"--set {values[0]}: there is no plant whose parameter that could be; name one by --plant"
        )
    found: dict[str, float] = {}
    for text in values:
        name, _, number = text.partition("=")
        try:
            found[name] = float(number)
        except ValueError:
            raise refusal(f"--set {text}: give NAME=VALUE, as stop_low=-1.0") from None
    return found


def _mounted(given: DrivesOptions) -> "Mounted":
    """Return what hangs on each drive; what makes no sense ends the program with a message."""
    from emulators.epos2.mounted import Mounted
    from emulators.fittings import FittingError, encoder, gear
    from emulators.motors import MotorError, motor

    if given.plant is not None:
        for name in ("motor", "load", "pole_pairs", "gear"):
            if getattr(given, name) is not None:
                raise refusal(
                    f"--{name.replace('_', '-')}: the plant has motors of its own; leave one of them out"
                )
    with one_message(MotorError, FittingError):
        geared, fitted = gear(given.gear or "1"), encoder(given.encoder)
        return Mounted(
            motor=None if given.motor is None else motor(given.motor),
            pulses=fitted.pulses,
            index=fitted.index,
            pole_pairs=given.pole_pairs,
            gear=geared.ratio,
            gear_inertia=geared.inertia_kg_m2,
            load=None if given.load is None else _load(given.load, named=given.motor is not None),
        )


def _text(mounted: "Mounted", plant: Path | None) -> str:
    if plant is None:
        return f"mounted: {mounted.text}"
    index = "with" if mounted.index else "without"
    return f"mounted: the plant {plant.name}, encoders with {mounted.pulses} pulses {index} index"


def _load(text: str, *, named: bool) -> "ShaftLoad":
    from emulators.epos2.mounted import ShaftLoad

    try:
        inertia, friction = (float(part) for part in text.split(","))
    except ValueError:
        raise refusal(f"--load {text}: give INERTIA,FRICTION in kg m2 and N m, as 2e-5,0.001") from None
    least = inertia >= 0.0 if named else inertia > 0.0
    if not (least and inertia < float("inf") and 0.0 <= friction < float("inf")):
        than = "not less than" if named else "more than"
        raise refusal(f"--load {text}: the inertia must be {than} 0, the friction not less")
    return ShaftLoad(inertia, friction)


def _commissioned(file: Path) -> "Mapping[Address, int]":
    from emulators.epos2.objects.parameters import is_parameter
    from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
    from firmware_bridge.runtime.data_sheets import SheetError, configured

    with one_message(SheetError):
        found = configured(file, ANY_TYPE).values
    return {address: value for address, value in found.items() if is_parameter(ANY_TYPE[address])}


emulate: Final = emulating(DrivesOptions, EXAMPLES, start)
