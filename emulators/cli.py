"""The simulation's commands, which it attaches to the bridge's program: `bench` and `emulate`."""

import re
from pathlib import Path
from typing import Annotated, Final

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from emulators import documents_cli, epos2_cli
from emulators.bench import mission as missions
from emulators.bench.mission import MissionFileError
from emulators.bench.report import show
from emulators.by_name import ByName
from emulators.devices import devices
from emulators.epos2.serial.serial_drive import baud_of
from emulators.epos2_cli import LatencyOption
from emulators.gateway import Cluster
from emulators.run import Order, drive
from emulators.servo.bank import ServoError
from emulators.servo.kernel import choose
from firmware_bridge.cli import epos2
from firmware_bridge.cli.console import find_robot, one_message, refusal, terminal, written_by
from firmware_bridge.cli.options import (
    ChannelOption,
    DurationOption,
    InterfaceOption,
    RobotArgument,
    RobotBitRateOption,
    until,
)
from firmware_bridge.cli.real_time import carry
from firmware_bridge.cli.serial_link import (
    Outside,
    ProtocolOption,
    SerialLinkOption,
    SerialNodeOption,
    SerialOption,
    on_the_line,
)
from firmware_bridge.drivers.serial.plan import PlanError
from firmware_bridge.node import SERIAL
from firmware_bridge.robot import Robot, RobotFileError
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds
from firmware_bridge.wire.maxon.frame import Generation
from fmu.errors import PlantError

RESULTS: Final = Path("out")
BENCH_EXAMPLES: Final = """Examples:

`firmware-bridge bench rars --mission line`

`firmware-bridge bench rars --mission line --serial v2` drives over the first drive's serial port.

`firmware-bridge bench rars --mission my_mission.toml --seed 7 --out results`"""
EMULATE_EXAMPLES: Final = """Examples:

`firmware-bridge emulate rars -i socketcan -c vcan0`

`firmware-bridge emulate rars -i socketcan -c vcan0 --silence 3@10` silences the steering after 10 s.

`firmware-bridge emulate rars --serial pty --serial-link rars.tty` puts the first drive on a serial line.

`firmware-bridge emulate epos2 --node 1-2 -i socketcan -c vcan0` brings two drives without a robot."""

PlantOption = Annotated[
    Path | None,
    typer.Option(
        "--plant",
        metavar="FMU",
        help="Another plant: an FMU (FMI 2.0 or 3.0, co-simulation) with the same variable names.",
        show_default=False,
    ),
]


EMULATE_HELP: Final = """Put emulated devices on a real CAN bus, in real time.

`emulate epos2` brings drives alone. `emulate ROBOT` brings the drives and the plant of a robot; the word
`robot` in front of the robot's name may be left out."""

devices_and_robots = typer.Typer(
    cls=ByName,
    help=EMULATE_HELP,
    no_args_is_help=True,
    epilog=EMULATE_EXAMPLES,
    # An option in front of the robot's name is the robot's.
    context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False},
)


def attach(program: typer.Typer) -> None:
    """Add the commands to the program."""
    program.command(epilog=BENCH_EXAMPLES)(bench)
    devices_and_robots.command("robot", epilog=EMULATE_EXAMPLES)(emulate)
    devices_and_robots.command("epos2", epilog=epos2_cli.EXAMPLES)(epos2_cli.emulate)
    program.add_typer(devices_and_robots, name="emulate")
    documents_cli.attach(epos2.group)


def bench(
    robot: RobotArgument,
    *,
    mission: Annotated[
        str,
        typer.Option(
            "--mission", "-m", metavar="NAME|FILE", help="A shipped mission, or a mission file (.toml)."
        ),
    ] = "circles",
    seed: Annotated[
        int, typer.Option("--seed", "-s", min=0, help="Chooses the noise; one seed, one run.")
    ] = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR", help="Where the results go.", show_default="out/ROBOT-MISSION"
        ),
    ] = None,
    plant: PlantOption = None,
    serial: Annotated[
        Generation | None,
        typer.Option(
            "--serial",
            help="Drive over the first drive's serial port instead of CAN, v1 as on RS232 or v2 as on USB.",
            show_default="as the robot file says",
        ),
    ] = None,
) -> None:
    """Drive a mission in virtual time: bridge, bus, drives and plant, all in this process.

    Leaves `summary.json`, `can.log` (candump's format), `operator.tlog` and plots in the results' folder.

    Shipped missions: `line`, `circles`, `interlocks`.
    """
    machine = find_robot(robot)
    if serial is not None:
        machine = machine.over_serial(serial)
    with (
        one_message(MissionFileError, RobotFileError, PlanError, PlantError, ServoError),
        written_by("--out"),
    ):
        script = missions.find(mission, machine)
        name = Path(mission).stem
        folder = out or RESULTS / f"{machine.name}-{name}"
        order = Order(machine, name, script, seed, folder, plant)
        _tell_of_twin()
        with _bar() as bar:
            task = bar.add_task(f"{machine.name}, {name}", total=order.duration)
            summary = drive(order, lambda now: bar.update(task, completed=now))
    show(terminal(), summary, machine.limits)
    typer.echo(f"results: {folder}/")


def emulate(
    robot: RobotArgument,
    *,
    interface: InterfaceOption = None,
    channel: ChannelOption = None,
    bit_rate: RobotBitRateOption = None,
    plant: PlantOption = None,
    silence: Annotated[
        list[str] | None,
        typer.Option(metavar="NODE@SECONDS", help="Cut a drive off the bus at this time; may be repeated."),
    ] = None,
    realistic_latency: LatencyOption = False,
    serial: SerialOption = None,
    serial_link: SerialLinkOption = None,
    serial_node: SerialNodeOption = None,
    protocol: ProtocolOption = Generation.V1,
    duration: DurationOption = None,
) -> None:
    """Put the robot's emulated drives and its plant on a real CAN bus, a serial line, or both, in real time.

    With --serial and neither -i nor -c the CAN bus is inside; the line reaches the other drives through it.

    Ends on Ctrl-C. On a machine without CAN hardware, make a virtual bus first:
    `sudo modprobe vcan && sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up`
    """
    machine = find_robot(robot)
    cuts = [_cut(machine, text) for text in silence or ()]
    near = on_the_line(serial_node, [axis.node for axis in machine.axes], serial=serial)
    with one_message(RobotFileError, PlantError, ServoError):
        _tell_of_twin()
        owner = next(axis.name for axis in machine.axes if axis.node == near)
        emulated = devices(
            machine,
            plant,
            realistic_latency=realistic_latency,
            serial={} if serial is None else {owner: protocol},
        )
    cluster = Cluster(emulated.drives, emulated.bank, owners={SERIAL: owner})
    for name, at in cuts:
        cluster.silence(name, at)
        typer.echo(f"'{name}' falls silent after {to_seconds(at):g} s")
    rate = machine.bus.bit_rate
    nodes = ", ".join(f"{axis.node} {axis.title}" for axis in machine.axes)
    outside = Outside(serial, serial_link, protocol, interface, channel, bit_rate, rate)
    openers, where = outside.openers(baud_of(emulated.drives[owner]))
    carry(
        cluster,
        openers,
        until(duration),
        f"{machine.name} is on {where}: {nodes}",
        PlantError,
        ServoError,
    )


def _tell_of_twin() -> None:
    """Say in one line when the drives run without their kernel; ServoError where one was asked for."""
    reason = choose().reason
    if reason:
        typer.echo(f"the drives' loops run in Python, which is slower: {reason}", err=True)


def _cut(robot: Robot, text: str) -> tuple[str, Nanoseconds]:
    """Read NODE@SECONDS, where the node may be a number or the name of an axis."""
    node, _, seconds = text.partition("@")
    for axis in robot.axes:
        if node in {str(axis.node), axis.name}:
            if not re.fullmatch(r"\d+(\.\d+)?", seconds):
                raise refusal(f"--silence {text}: say NODE@SECONDS, as {axis.node}@10")
            return axis.name, from_seconds(float(seconds))
    known = ", ".join(f"{axis.node} ({axis.name})" for axis in robot.axes)
    raise refusal(f"--silence {text}: {robot.name} has no node '{node}'; it has {known}")


def _bar() -> Progress:
    """Return a progress bar that shows on a terminal only."""
    console = terminal(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
        transient=True,
    )
