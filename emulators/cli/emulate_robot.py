"""A robot's drives and plant on a real bus, at the command line: `emulate ROBOT`."""

import re
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated, Final

import typer

from emulators.cli.options import LatencyOption, ParametersOption, PlantOption, parameter_file
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.options import (
    DurationOption,
    EncodersOption,
    LinkOption,
    RobotArgument,
    RobotBitRateOption,
    until,
)
from firmware_bridge.cli.outside import Outside
from firmware_bridge.cli.recorded import RecordOption, recording
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.node import CAN, SERIAL, Node
from firmware_bridge.recording import device_side
from firmware_bridge.runtime.black_box import CAN_LOG, SERIAL_LOG
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds

if TYPE_CHECKING:
    from collections.abc import Callable

    from emulators.canopen.saved_parameters import Storage
    from firmware_bridge.cli.links import Openers
    from firmware_bridge.cli.places import BusAddress
    from firmware_bridge.families.epos2.maxon.frame import Generation
    from firmware_bridge.robot import AnyRobot, Axis
    from firmware_bridge.runtime.ports import Port


EXAMPLES: Final = """Examples:

`firmware-bridge emulate rars -i socketcan -c vcan0`

`firmware-bridge emulate rars -i socketcan -c vcan0 --silence 3@10` silences node 3 after 10 s.

`firmware-bridge emulate rars --serial pty --serial-link rars.tty` puts the first drive on a serial line.

`firmware-bridge emulate rome --serial pty --serial-link rome.tty` puts a board with a motor shield on a line.

`firmware-bridge emulate epos2 --node 1-2 -i socketcan -c vcan0` emulates two drives without a robot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotOptions(Outside):
    """Put the robot's emulated drives and its plant on a real CAN bus, a serial line, or both, in real time.

    A robot with several links names a place for each: --link base=socketcan:can0 --link arm=socketcan:can1.

    With --serial and neither -i nor -c the CAN bus is inside; the line reaches the other drives through it.

    Ends on Ctrl-C. On a machine without CAN hardware, make a virtual bus first:
    `sudo modprobe vcan && sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up`
    """

    robot: RobotArgument
    protocol: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Protocol of the serial line: v1 as on RS232, v2 as on USB; for a board with a motor "
            "shield its firmware.",
            show_default="as its host does; of a board by the robot file",
        ),
    ] = None
    encoders: EncodersOption = None
    bit_rate: RobotBitRateOption = None
    plant: PlantOption = None
    silence: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NODE@SECONDS", help="Disconnect a drive from the bus at this time; may be repeated."
        ),
    ] = None
    factory: Annotated[
        bool,
        typer.Option(
            "--factory",
            help="Drives with factory settings; without it they have the gains and limits of the robot "
            "file, as after commissioning.",
        ),
    ] = False
    parameters: ParametersOption = None
    realistic_latency: LatencyOption = False
    link: LinkOption = None
    record: RecordOption = None
    duration: DurationOption = None


def run(given: RobotOptions) -> None:
    """Run the command `emulate ROBOT`; an error ends the program with a message."""
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.robot.table import Medium

    machine = find_robot(given.robot)
    drives = Epos2Link.all_of(machine)
    if any(link.medium is Medium.SERIAL for name, link in machine.links.items() if name not in drives):
        if drives:
            raise refusal(f"{machine.name} has boards and drives: real ports take one of both; use `bench`")
        emulate_board(machine, given)
    else:
        emulate_drives(machine, given)


def emulate_board(machine: "AnyRobot", given: RobotOptions) -> None:
    """Put a robot's boards on serial lines, with its plant at the shield's terminals, or on its pulses."""
    from emulators.arduino_omni.ar2.board import Ar2Board
    from emulators.arduino_omni.board import Board
    from emulators.cli.beginning import report_beginning
    from emulators.cli.cameras import beside_boards, cameras_of
    from emulators.cli.watched import keeping_reported
    from emulators.devices import devices
    from emulators.servo.bank import ServoError
    from firmware_bridge.cli.fitted import linked
    from firmware_bridge.cli.real_time import carry
    from firmware_bridge.dissector import kinds_of
    from firmware_bridge.family import LinkOptions
    from firmware_bridge.robot import RobotFileError
    from firmware_bridge.runtime.clock import LivedClock
    from firmware_bridge.runtime.ports import PortError
    from fmu.errors import PlantError

    with one_message(RobotFileError, PlantError):
        machine = linked(machine, LinkOptions(given.protocol, encoders=given.encoders))
        report_beginning(machine, given.plant)
        emulated = devices(machine, given.plant)
        cameras = cameras_of(machine, emulated)
    boards = emulated.nodes(Board) | emulated.nodes(Ar2Board)
    alone = len(boards) == 1
    links = {name: SERIAL if alone else name for name in boards}
    for name, board in boards.items():
        keeping_reported(board.mega, name)
    node = beside_boards(boards, links, cameras)
    files = {link: SERIAL_LOG if alone else f"{name}-{SERIAL_LOG}" for name, link in links.items()}
    kinds = kinds_of(machine)
    called = {link: device_side(name, kinds[name]) for name, link in links.items()}
    with recording(given.record, files, called=called) as (around, _):
        with one_message(PortError):
            lines = {name: _line_of(machine, name, given, alone=alone) for name in links}
        of_boards = (f"{'' if alone else f'{name} on '}{line.name}" for name, line in lines.items())
        spoken_there = ", ".join(_spoken(machine, name) for name in links)
        carry(
            around(node),
            {**{links[name]: partial(_same, line) for name, line in lines.items()}, **cameras.openers},
            until(given.duration),
            f"{machine.name} is on {', '.join((*of_boards, *cameras.where))}: {spoken_there}",
            PlantError,
            ServoError,
            clock=LivedClock(),
        )


def _same(port: "Port") -> "Port":
    """Return what was opened already, because its name is found out only then."""
    return port


def _line_of(machine: "AnyRobot", name: str, given: RobotOptions, *, alone: bool) -> "Port":
    """Open the line to a board; where there are several each has a pseudo-terminal of its own. PortError."""
    from firmware_bridge.cli.links import open_serial
    from firmware_bridge.runtime.ports import PortError
    from firmware_bridge.runtime.ports.pseudo_terminal import WORD

    table = machine.links[name]
    rate = table.rate
    link, device = given.serial_link, given.serial or WORD
    if alone:
        return open_serial(device, rate, link)
    if device != WORD:
        raise PortError(f"--serial {device}: {machine.name} has several boards; use --serial {WORD}")
    return open_serial(device, rate, None if link is None else link.with_name(f"{link.name}-{name}"))


def _spoken(machine: "AnyRobot", name: str) -> str:
    """Return what a board speaks."""
    from firmware_bridge.families.motor_shield.settings import ShieldLink

    table = machine.links[name]
    if not isinstance(table, ShieldLink):
        return Ar2Link.of_link(machine, name).protocol.value
    return f"{table.protocol.value}, {table.counted} encoders{'' if table.stock else ', not stock'}"


def emulate_drives(machine: "AnyRobot", given: RobotOptions) -> None:
    """Put a robot's drives on a bus, a serial line, or both."""
    from emulators.canopen.saved_parameters import StorageError
    from emulators.cli.beginning import report_beginning
    from emulators.cli.cameras import cameras_of
    from emulators.cli.watched import RollCalled, duplicates_reported
    from emulators.devices import devices
    from emulators.epos2.drive import Epos2
    from emulators.epos2.family import Epos2Options
    from emulators.epos2.serial.serial_drive import baud_of
    from emulators.gateway import Cluster
    from emulators.servo.bank import ServoError
    from firmware_bridge.cli.links import on_the_line
    from firmware_bridge.cli.real_time import carry
    from firmware_bridge.robot import RobotFileError
    from firmware_bridge.runtime.clock import LivedClock
    from fmu.errors import PlantError

    protocol = _generation(given.protocol)
    cuts = [_cut(machine, text) for text in given.silence or ()]
    near = on_the_line(given, [Epos2Axis.of(axis).node for axis in machine.axes])
    if given.link is None and len(Epos2Link.all_of(machine)) > 1 and given.serial is not None:
        raise refusal("--serial is of a robot with one link; here only --link NAME=INTERFACE:CHANNEL works")
    with one_message(RobotFileError, PlantError, ServoError, StorageError):
        report_beginning(machine, given.plant)
        owner = next(axis.name for axis in machine.axes if Epos2Axis.of(axis).node == near)
        emulated = devices(
            machine,
            given.plant,
            realistic_latency=given.realistic_latency,
            options=(
                Epos2Options(
                    serial={} if given.serial is None else {owner: protocol},
                    storages={axis.name: _storage(axis, given) for axis in machine.axes},
                ),
            ),
        )
        drives = emulated.nodes(Epos2)
        cameras = cameras_of(machine, emulated)
    outer = {
        axis.name: {CAN: axis.link if len(Epos2Link.all_of(machine)) > 1 else CAN} for axis in machine.axes
    }
    outer[owner] = {**outer[owner], SERIAL: SERIAL}
    members: dict[str, Node] = {**drives, **cameras.members}
    cluster = Cluster(members, cameras.physics, links={**outer, **cameras.links})
    for name, at in cuts:
        cluster.silence(name, at)
        say(f"'{name}' falls silent after {to_seconds(at):g} s")
    nodes = ", ".join(f"{Epos2Axis.of(axis).node} {axis.title}" for axis in machine.axes)
    files = dict.fromkeys((CAN, *machine.links), CAN_LOG) | {SERIAL: SERIAL_LOG}
    called = {SERIAL: device_side(owner, SERIAL)}
    places = [(outer[axis.name][CAN], Epos2Axis.of(axis).node) for axis in machine.axes]
    with recording(given.record, files, called=called) as (around, _):
        openers, where = _outside(machine, baud_of(drives[owner]), given)
        carry(
            RollCalled(around(duplicates_reported(cluster, places)), places),
            {**openers, **cameras.openers},
            until(given.duration),
            f"{machine.name} is on {', '.join((where, *cameras.where))}: {nodes}",
            PlantError,
            ServoError,
            clock=LivedClock(),
        )


def _generation(spoken: str | None) -> "Generation | None":
    """Return the protocol of drives; another one ends the program with a message."""
    from firmware_bridge.families.epos2.maxon.frame import Generation

    known = [one.value for one in Generation]
    if spoken is not None and spoken not in known:
        raise refusal(f"--protocol {spoken}: drives speak {' or '.join(known)}")
    return None if spoken is None else Generation(spoken)


def _storage(axis: "Axis", given: RobotOptions) -> "Storage":
    """Return where a drive finds its parameters at power-on: saved, the robot file's or the factory's."""
    from emulators.canopen.saved_parameters import Volatile
    from emulators.storage import Commissioned, ParameterFile
    from firmware_bridge.families.epos2.driver.setup import commissioned

    folder = given.parameters
    kept: Storage = (
        Volatile() if folder is None else ParameterFile(parameter_file(folder, Epos2Axis.of(axis).node))
    )
    if given.factory:
        return kept
    return Commissioned({row.address: row.value for row in commissioned(axis)}, kept)


def _outside(machine: "AnyRobot", baud: int, given: RobotOptions) -> "tuple[Openers, str]":
    """Return what opens each link, and the text that names them."""
    from emulators.cli.drive_links import drives_opened
    from firmware_bridge.cli.places import BusAddress, places_of

    single = len(Epos2Link.all_of(machine)) == 1
    if single and not given.link:
        return drives_opened(
            given, _generation(given.protocol), baud, next(iter(Epos2Link.all_of(machine).values())).bit_rate
        )
    places = places_of(machine, given.link, BusAddress(given.interface, given.channel, given.serial))
    openers = {CAN if single else name: _opener(machine, name, place) for name, place in places.items()}
    return openers, ", ".join(f"{place.title} ({name})" for name, place in places.items())


def _opener(machine: "AnyRobot", name: str, place: "BusAddress") -> "Callable[[], Port]":
    from firmware_bridge.runtime.ports import open_can

    if place.device is not None:
        raise refusal(
            f"--link {name}: emulated drives of a robot are put on CAN here; give INTERFACE:CHANNEL"
        )
    rate = Epos2Link.of_link(machine, name).bit_rate
    return lambda: open_can(place.interface, place.channel, None, default_bit_rate=rate, say=say)


def _cut(robot: "AnyRobot", text: str) -> tuple[str, Nanoseconds]:
    """Read NODE@SECONDS, where the node may be a number or the name of an axis."""
    node, _, seconds = text.partition("@")
    for axis in robot.axes:
        if node in {str(Epos2Axis.of(axis).node), axis.name}:
            if not re.fullmatch(r"\d+(\.\d+)?", seconds):
                raise refusal(f"--silence {text}: give NODE@SECONDS, as {Epos2Axis.of(axis).node}@10")
            return axis.name, from_seconds(float(seconds))
    known = ", ".join(f"{Epos2Axis.of(axis).node} ({axis.name})" for axis in robot.axes)
    raise refusal(f"--silence {text}: {robot.name} has no node '{node}'; it has {known}")


emulate: Final = command(EXAMPLES, work=run)(RobotOptions)
