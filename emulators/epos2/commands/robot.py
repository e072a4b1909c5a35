"""A robot's drives on a CAN bus, a serial line, or both, at the command line."""

from typing import TYPE_CHECKING

from emulators.cli.emulation import Emulation
from emulators.cli.options import parameter_file
from emulators.cli.silences import silence_of
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.node import CAN, SERIAL, Node
from firmware_bridge.recording import device_side
from firmware_bridge.runtime.black_box import CAN_LOG, SERIAL_LOG
from firmware_bridge.units import to_seconds

if TYPE_CHECKING:
    from collections.abc import Callable

    from emulators.canopen.saved_parameters import Storage
    from emulators.cli.emulate_robot import RobotOptions
    from emulators.family import Beside
    from firmware_bridge.cli.links import Openers
    from firmware_bridge.cli.places import BusAddress
    from firmware_bridge.families.epos2.maxon.frame import Generation
    from firmware_bridge.robot import AnyRobot, Axis
    from firmware_bridge.runtime.ports import Port


def emulate_drives(machine: "AnyRobot", given: "RobotOptions") -> Emulation:
    """Make a robot's drives, for a bus, a serial line, or both."""
    from emulators.canopen.saved_parameters import StorageError
    from emulators.cli.beginning import report_beginning
    from emulators.cli.beside import beside_of
    from emulators.cli.watched import RollCalled, duplicates_reported
    from emulators.devices import devices
    from emulators.epos2.drive import Epos2
    from emulators.epos2.options import Epos2Options
    from emulators.epos2.serial.serial_drive import baud_of
    from emulators.gateway import Cluster
    from emulators.servo.bank import ServoError
    from firmware_bridge.cli.links import on_the_line
    from firmware_bridge.robot import RobotFileError
    from fmu.errors import PlantError

    protocol = _generation(given.protocol)
    cuts = [silence_of(machine, text) for text in given.silence or ()]
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
            report=say,
            options=(
                Epos2Options(
                    serial={} if given.serial is None else {owner: protocol},
                    storages={axis.name: _storage(axis, given) for axis in machine.axes},
                ),
            ),
        )
        drives = emulated.nodes(Epos2)
        cameras = beside_of(machine, emulated)
    outer = {
        axis.name: {CAN: axis.link if len(Epos2Link.all_of(machine)) > 1 else CAN} for axis in machine.axes
    }
    outer[owner] = {**outer[owner], SERIAL: SERIAL}
    members: dict[str, Node] = {**drives, **cameras.members}
    cluster = Cluster(members, emulated.physics, links={**outer, **cameras.links})
    for name, at in cuts:
        cluster.silence(name, at)
        say(f"'{name}' falls silent after {to_seconds(at):g} s")
    nodes = ", ".join(f"{Epos2Axis.of(axis).node} {axis.title}" for axis in machine.axes)
    files = dict.fromkeys((CAN, *machine.links), CAN_LOG) | {SERIAL: SERIAL_LOG}
    called = {SERIAL: device_side(owner, SERIAL)}
    places = [(outer[axis.name][CAN], Epos2Axis.of(axis).node) for axis in machine.axes]
    return Emulation(
        node=duplicates_reported(cluster, places),
        opened=lambda: _outside(machine, baud_of(drives[owner]), given, cameras),
        text=lambda where: f"{machine.name} is on {where}: {nodes}",
        errors=(PlantError, ServoError),
        files=files,
        called=called,
        around=lambda node: RollCalled(node, places),
    )


def _generation(spoken: str | None) -> "Generation | None":
    """Return the protocol of drives; another one ends the program with a message."""
    from firmware_bridge.families.epos2.maxon.frame import Generation

    known = [one.value for one in Generation]
    if spoken is not None and spoken not in known:
        raise refusal(f"--protocol {spoken}: drives speak {' or '.join(known)}")
    return None if spoken is None else Generation(spoken)


def _storage(axis: "Axis", given: "RobotOptions") -> "Storage":
    """Return where a drive finds its parameters at power-on: saved, the robot file's or the factory's."""
    from emulators.canopen.saved_parameters import Volatile
    from emulators.epos2.storage import Commissioned, ParameterFile
    from firmware_bridge.families.epos2.driver.product import commissioned

    folder = given.parameters
    kept: Storage = (
        Volatile() if folder is None else ParameterFile(parameter_file(folder, Epos2Axis.of(axis).node))
    )
    if given.factory:
        return kept
    return Commissioned({row.address: row.value for row in commissioned(axis)}, kept)


def _outside(
    machine: "AnyRobot", baud: int, given: "RobotOptions", beside: "Beside"
) -> "tuple[Openers, str]":
    """Return what opens each link, and the text that names them."""
    from emulators.epos2.commands.links import drives_opened
    from firmware_bridge.cli.places import BusAddress, places_of

    links = Epos2Link.all_of(machine)
    if len(links) == 1 and not given.link:
        (link,) = links.values()
        openers, where = drives_opened(given, _generation(given.protocol), baud, link.bit_rate)
    else:
        places = places_of(machine, given.link, BusAddress(given.interface, given.channel, given.serial))
        single = len(links) == 1
        openers = {CAN if single else name: _opener(machine, name, place) for name, place in places.items()}
        where = ", ".join(f"{place.title} ({name})" for name, place in places.items())
    return {**openers, **beside.openers}, ", ".join((where, *beside.where))


def _opener(machine: "AnyRobot", name: str, place: "BusAddress") -> "Callable[[], Port]":
    from firmware_bridge.runtime.ports import open_can

    if place.device is not None:
        raise refusal(
            f"--link {name}: emulated drives of a robot are put on CAN here; give INTERFACE:CHANNEL"
        )
    rate = Epos2Link.of_link(machine, name).bit_rate
    return lambda: open_can(place.interface, place.channel, None, default_bit_rate=rate, say=say)
